// SPDX-License-Identifier: MIT
// The arithmetic of candidates from a few planes: smoothing, depth between planes, position. Host and device.
#pragma once

#include <cmath>
#include <cstdint>

#include "reconstruct/light_field/ray_count_kernel.hpp"

namespace rptv {

/// Where a particle may be: image space, mm.
struct Candidate {
  float x_mm, y_mm, z_mm;
  std::uint32_t rays;  ///< through the 3×3 voxels round it on its plane: no fit near it can explain many more
};

/// Candidate at (fractional) voxel numbers; count(x, y, plane) is the ray counter.
template <class Count>
RPTV_HOST_DEVICE inline Candidate candidate_at(const VoxelGrid& grid, const Count& count, double x, double y,
                                               double z) noexcept {
  const auto near_x = static_cast<std::int32_t>(lround(x)), near_y = static_cast<std::int32_t>(lround(y));
  const auto plane = static_cast<std::int32_t>(lround(z));
  std::uint32_t rays = 0;
  for (std::int32_t j = near_y - 1; j <= near_y + 1; ++j)
    for (std::int32_t i = near_x - 1; i <= near_x + 1; ++i) rays += count(i, j, plane);
  return {grid.first_x_mm + static_cast<float>(x - 1) * grid.step_x_mm,
          grid.first_y_mm + static_cast<float>(y - 1) * grid.step_y_mm,
          grid.first_z_mm + static_cast<float>(z) * grid.step_z_mm, rays};
}

/// Counts are smoothed by the weights 1-2-1 along x and y, which add up to 16, and stop here for that.
constexpr std::uint16_t kMostSmoothable = 65535 / 16;

/// Least smoothed count of a maximum: 1-2-1 weighs more than 3×3.
RPTV_HOST_DEVICE inline std::uint16_t smoothed_bound(std::uint16_t least) noexcept {
  const std::uint16_t bound = least < kMostSmoothable ? least : kMostSmoothable;
  return bound > 1 ? bound : std::uint16_t{1};
}

/// Offset in planes, within ±0.49, of the vertex of the parabola through three counts; 0 where they do not bend down.
RPTV_HOST_DEVICE inline double depth_offset_of(double before, double here, double after) noexcept {
  const double bend = before - 2.0 * here + after;
  if (!(bend < 0)) return 0;
  const double offset = 0.5 * (before - after) / bend;
  return offset < -0.49 ? -0.49 : offset > 0.49 ? 0.49 : offset;
}

}  // namespace rptv
