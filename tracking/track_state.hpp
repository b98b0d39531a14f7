// SPDX-License-Identifier: MIT
// What the linker remembers of one track between frames.
#pragma once

#include <cstdint>

namespace rptv {

/// Where a track was last seen and how it moved. Position mm, velocity mm/s, in the particles' frame of reference.
struct TrackState {
  double x_mm = 0, y_mm = 0, z_mm = 0;
  double vx_mm_s = 0, vy_mm_s = 0, vz_mm_s = 0;
  std::uint64_t id = 0;
  std::int64_t seen_ns = 0;       ///< FrameClock time
  std::uint64_t seen_frame = 0;   ///< FrameClock frame
  std::uint32_t clock_epoch = 0;  ///< times of different epochs give no velocity
  std::uint32_t age_frames = 0;   ///< frames in which it was seen before the last one
};

}  // namespace rptv
