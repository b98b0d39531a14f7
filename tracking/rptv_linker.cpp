// SPDX-License-Identifier: MIT
// The C library: pointers in, pointers out, and no exception beyond it.
#include "tracking/rptv_linker.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <span>
#include <string>
#include <vector>

#include "core/settings.hpp"
#include "tracking/linker.hpp"

struct rptv_linker {
  explicit rptv_linker(const rptv::LinkerSettings& settings)
      : linker(settings), particles(static_cast<std::size_t>(settings.max_particles)), tracks(linker.capacity()) {}
  rptv::Linker linker;
  rptv::Particles particles;
  rptv::Tracks tracks;
};

namespace {

void say(const std::exception& problem, char* error, std::size_t bytes) noexcept {
  if (error == nullptr || bytes == 0) return;
  std::strncpy(error, problem.what(), bytes - 1);
  error[bytes - 1] = '\0';
}

rptv_track track_of(const rptv::Tracks& tracks, std::size_t row) noexcept {
  rptv_track track{tracks.particle[row],
                   tracks.age_frames[row],
                   tracks.x_mm[row],
                   tracks.y_mm[row],
                   tracks.z_mm[row],
                   tracks.vx_mm_s[row],
                   tracks.vy_mm_s[row],
                   tracks.vz_mm_s[row],
                   0,
                   0,
                   0};
  if (!tracks.estimate.empty()) {
    track.ax = tracks.estimate[row].ax_mm_s2;
    track.ay = tracks.estimate[row].ay_mm_s2;
    track.az = tracks.estimate[row].az_mm_s2;
  }
  return track;
}

}  // namespace

rptv_linker* rptv_linker_new(const char* settings, char* error, size_t error_bytes) {
  try {
    rptv::LinkerSettings chosen;
    rptv::FieldList fields;
    chosen.fields(fields);
    rptv::read_toml_text(settings == nullptr ? "" : settings, "settings", "settings of the linker", 1, fields);
    return new rptv_linker(chosen);
  } catch (const std::exception& problem) {
    say(problem, error, error_bytes);
    return nullptr;
  }
}

void rptv_linker_free(rptv_linker* linker) { delete linker; }

int rptv_linker_seed(rptv_linker* linker, size_t count, const double* p, const double* v) {
  try {
    std::vector<rptv::VelocitySample> samples;
    for (std::size_t i = 0; i < 3 * count; i += 3)
      samples.push_back({p[i], p[i + 1], p[i + 2], v[i], v[i + 1], v[i + 2]});
    linker->linker.seed(samples);
    return 0;
  } catch (const std::exception&) {
    return -1;
  }
}

size_t rptv_linker_next(rptv_linker* linker, uint64_t frame, int64_t exposure_end_ns, size_t count, const double* x,
                        const double* y, const double* z, const double* covariance, rptv_track* out) {
  rptv::Particles& particles = linker->particles;
  rptv::Tracks& tracks = linker->tracks;
  particles.clear();
  const std::size_t taken = std::min(count, particles.capacity());
  for (std::size_t i = 0; i < taken; ++i) {
    rptv::Particle particle{x[i], y[i], z[i], 0, 0, {}};
    if (covariance != nullptr) std::copy_n(covariance + 6 * i, 6, particle.covariance_mm2.begin());
    particles.push(particle);
  }
  linker->linker.next(particles, frame, exposure_end_ns, tracks);
  std::size_t row = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool linked = i < taken && std::isfinite(x[i]) && std::isfinite(y[i]) && std::isfinite(z[i]);
    out[i] = linked ? track_of(tracks, row++) : rptv_track{RPTV_NO_TRACK, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  }
  return tracks.deaths.size();
}

const uint64_t* rptv_linker_ended(const rptv_linker* linker) { return linker->tracks.deaths.data(); }
size_t rptv_linker_live(const rptv_linker* linker) { return linker->linker.live_tracks(); }

size_t rptv_linker_predict(rptv_linker* linker, int64_t exposure_ns, rptv_track* out, size_t capacity) {
  linker->linker.predict(exposure_ns, linker->tracks);
  const std::size_t count = std::min(capacity, linker->tracks.size());
  for (std::size_t row = 0; row < count; ++row) out[row] = track_of(linker->tracks, row);
  return count;
}

uint64_t rptv_linker_cut_subnets(const rptv_linker* linker) { return linker->linker.counters().cut_subnets; }

size_t rptv_linker_snapshot(const rptv_linker* linker, void* bytes, size_t capacity) {
  try {
    const std::vector<std::byte> snapshot = linker->linker.snapshot();
    if (capacity > 0) std::memcpy(bytes, snapshot.data(), std::min(capacity, snapshot.size()));
    return snapshot.size();
  } catch (const std::exception&) {
    return 0;
  }
}

int rptv_linker_restore(rptv_linker* linker, const void* bytes, size_t size, char* error, size_t error_bytes) {
  try {
    linker->linker.restore({static_cast<const std::byte*>(bytes), size});
    return 0;
  } catch (const std::exception& problem) {
    say(problem, error, error_bytes);
    return -1;
  }
}
