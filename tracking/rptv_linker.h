/* SPDX-License-Identifier: MIT */
/* The linker as a plain C library (librptv_linker), for Python's ctypes and other languages. */
#ifndef RPTV_LINKER_H
#define RPTV_LINKER_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define RPTV_API __attribute__((visibility("default")))
#else
#define RPTV_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Links the particles of one frame after another into tracks; docs/linking.md says how. One thread at a time each. */
typedef struct rptv_linker rptv_linker;

/* A track in one frame, in memory order. Units mm, mm/s, mm/s^2; acceleration 0 without a Kalman filter. */
typedef struct rptv_track {
  uint64_t id;  /* never reused; RPTV_NO_TRACK for a particle that is not finite or beyond max_particles */
  uint64_t age; /* frames in which it was seen before this one */
  double x, y, z, vx, vy, vz, ax, ay, az;
} rptv_track;

#define RPTV_NO_TRACK UINT64_MAX

/* `settings` is TOML: the keys of [linker] in the configuration, as in "search_range_mm = 0.5\nmemory = 3\n"; what is
   absent keeps its default. NULL, and a line in `error` (may be NULL; at most error_bytes with its end), when they are
   refused or memory is short. */
RPTV_API rptv_linker* rptv_linker_new(const char* settings, char* error, size_t error_bytes);
RPTV_API void rptv_linker_free(rptv_linker* linker); /* NULL is fine */

/* Tells of the flow before the first frame: `count` positions (mm) and velocities (mm/s), x y z each in turn. 0, or -1
   when a value is not finite. */
RPTV_API int rptv_linker_seed(rptv_linker* linker, size_t count, const double* positions, const double* velocities);

/* One frame. x, y, z: `count` positions, mm; covariance: 6 numbers a particle (xx xy xz yy yz zz, mm^2), or NULL; out:
   `count` tracks, one per particle in its order. `frame` should increase; exposure_end_ns is the time on the camera's
   clock. Returns the number of tracks that have ended; their ids can be had until the next call. */
RPTV_API size_t rptv_linker_next(rptv_linker* linker, uint64_t frame, int64_t exposure_end_ns, size_t count,
                                 const double* x, const double* y, const double* z, const double* covariance,
                                 rptv_track* out);
RPTV_API const uint64_t* rptv_linker_ended(const rptv_linker* linker);

/* All live tracks as they are expected at a time on the exposures' clock. Writes at most `capacity` and returns how
   many were written; rptv_linker_live() are there. */
RPTV_API size_t rptv_linker_live(const rptv_linker* linker);
RPTV_API size_t rptv_linker_predict(rptv_linker* linker, int64_t exposure_ns, rptv_track* out, size_t capacity);

/* Subnetworks since the start that were only approximated, for lack of time. 0: all tracks so far are exact. */
RPTV_API uint64_t rptv_linker_cut_subnets(const rptv_linker* linker);

/* Bytes from which a linker with the same settings goes on. snapshot: writes at most `capacity` bytes and returns how
   many there are (call it with 0 first). restore: 0, or -1 with a line in `error`. */
RPTV_API size_t rptv_linker_snapshot(const rptv_linker* linker, void* bytes, size_t capacity);
RPTV_API int rptv_linker_restore(rptv_linker* linker, const void* bytes, size_t size, char* error, size_t error_bytes);

#ifdef __cplusplus
}
#endif
#endif
