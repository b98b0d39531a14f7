// SPDX-License-Identifier: MIT
// Scan of the counters for voxels at or above C_min.
#include "reconstruct/voxel_cloud.hpp"

#include <algorithm>

namespace rptv {

std::size_t VoxelCloud::collect(const RayCounter& counter, std::uint16_t least) noexcept {
  voxels_.clear();
  const auto& grid = counter.grid();
  std::size_t refused = 0;
  for (std::int32_t z = 0; z < grid.planes; ++z)
    for (std::int32_t y = 1; y <= grid.size_y; ++y) {
      const std::uint16_t* row = counter.plane(z).data() + grid.index(0, y);
      std::uint16_t highest = 0;
      for (std::int32_t x = 1; x <= grid.size_x; ++x) highest = std::max(highest, row[x]);  // vectorised
      if (highest < least) continue;
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
