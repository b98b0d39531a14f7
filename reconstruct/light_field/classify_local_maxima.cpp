// SPDX-License-Identifier: MIT
// Local maxima of the ray counter.
#include "reconstruct/light_field/classify_local_maxima.hpp"

#include <algorithm>

namespace rptv {

namespace {

bool is_maximum(const RayCounter& counter, const CloudVoxel& v, const std::array<std::int32_t, 3>& half) noexcept {
  const auto& grid = counter.grid();
  for (std::int32_t z = std::max(v.z - half[2], 0); z <= std::min(v.z + half[2], grid.planes - 1); ++z)
    for (std::int32_t y = std::max(v.y - half[1], 1); y <= std::min(v.y + half[1], grid.size_y); ++y) {
      const std::uint16_t* row = counter.plane(z).data() + grid.index(0, y);
      for (std::int32_t x = std::max(v.x - half[0], 1); x <= std::min(v.x + half[0], grid.size_x); ++x) {
        const bool earlier = z != v.z ? z < v.z : y != v.y ? y < v.y : x < v.x;
        if (row[x] > v.count || (row[x] == v.count && earlier)) return false;
      }
    }
  return true;
}

}  // namespace

std::size_t classify_local_maxima(const RayCounter& counter, const VoxelCloud& cloud,
                                  const std::array<std::int32_t, 3>& half_width,
                                  std::vector<Candidate>& candidates) noexcept {
  std::size_t refused = 0;
  for (const auto& v : cloud.voxels()) {
    if (!is_maximum(counter, v, half_width)) continue;
    if (candidates.size() == candidates.capacity())
      ++refused;
    else
      candidates.push_back(candidate_at(counter, v.x, v.y, v.z));
  }
  return refused;
}

}  // namespace rptv
