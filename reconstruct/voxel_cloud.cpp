// SPDX-License-Identifier: MIT
// Scan of the counters for voxels at or above C_min.
#include "reconstruct/voxel_cloud.hpp"

#include <cmath>

namespace rptv {

Candidate candidate_at(const RayCounter& counter, double x, double y, double z) noexcept {
  const auto& grid = counter.grid();
  const auto near_x = static_cast<std::int32_t>(std::lround(x)), near_y = static_cast<std::int32_t>(std::lround(y));
  std::uint32_t rays = 0;
  for (std::int32_t j = near_y - 1; j <= near_y + 1; ++j)
    for (std::int32_t i = near_x - 1; i <= near_x + 1; ++i)
      rays += counter.at(i, j, static_cast<std::int32_t>(std::lround(z)));
  return {grid.first_x_mm + static_cast<float>(x - 1) * grid.step_x_mm,
          grid.first_y_mm + static_cast<float>(y - 1) * grid.step_y_mm,
          grid.first_z_mm + static_cast<float>(z) * grid.step_z_mm, rays};
}

std::size_t VoxelCloud::collect(const RayCounter& counter, std::uint16_t least) noexcept {
  voxels_.clear();
  const auto& grid = counter.grid();
  std::size_t refused = 0;
  for (std::int32_t z = 0; z < grid.planes; ++z)
    for (std::int32_t y = 1; y <= grid.size_y; ++y) {
      const std::uint16_t* row = counter.plane(z).data() + grid.index(0, y);
      std::uint16_t any = 0;
      for (std::int32_t x = 1; x <= grid.size_x; ++x) any |= static_cast<std::uint16_t>(row[x] >= least);  // vectorised
      if (any == 0) continue;
      for (std::int32_t x = 1; x <= grid.size_x; ++x) {
        if (row[x] < least) continue;
        if (voxels_.size() < voxels_.capacity())
          voxels_.push_back({x, y, z, row[x]});
        else
          ++refused;
      }
    }
  return refused;
}

}  // namespace rptv
