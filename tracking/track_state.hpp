// SPDX-License-Identifier: MIT
// What the linker remembers of one track between frames.
#pragma once

#include <cstdint>

namespace rptv {

/// Where a track was last seen and how it moves: one cache line. Position mm, velocity mm/s, in the particles' frame of
/// reference.
struct alignas(64) TrackState {
  double x_mm = 0, y_mm = 0, z_mm = 0;
  double vx_mm_s = 0, vy_mm_s = 0, vz_mm_s = 0;  ///< of a track of age 0: what start-up expects of it
  std::uint64_t id = 0;
  std::uint32_t age_frames = 0;  ///< frames in which it was seen before the last one
  std::uint32_t slot = 0;        ///< of its Kalman filter, if there is one
};
static_assert(sizeof(TrackState) == 64);

/// When a track was last seen, on the FrameClock.
struct Seen {
  std::int64_t ns = 0;
  std::uint64_t frame = 0;
  std::uint32_t clock_epoch = 0;  ///< times of different epochs give no velocity
};

}  // namespace rptv
