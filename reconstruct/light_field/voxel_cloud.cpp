// SPDX-License-Identifier: MIT
// From marks to voxels.
#include "reconstruct/light_field/voxel_cloud.hpp"

#include <bit>

namespace rptv {

Candidate candidate_at(const RayCounter& counter, double x, double y, double z) noexcept {
  return candidate_at(
      counter.grid(), [&](std::int32_t i, std::int32_t j, std::int32_t plane) { return counter.at(i, j, plane); }, x, y,
      z);
}

std::size_t VoxelCloud::collect(const RayCounter& counter) noexcept {
  clear();
  const auto& grid = counter.grid();
  std::size_t refused = 0;
  for (std::int32_t z = 0; z < grid.planes; ++z) {
    const auto marks = counter.marks(z);
    const std::uint16_t* counts = counter.plane(z).data();
    std::int32_t y = 0, row = 0;  // of the last mark; the marks go by rising index
    for (std::size_t word = 0; word < marks.size(); ++word)
      for (std::uint64_t left = marks[word]; left != 0; left &= left - 1) {
        const auto index = static_cast<std::int32_t>(64 * word) + std::countr_zero(left);
        while (index - row >= grid.stride()) ++y, row += grid.stride();
        const std::int32_t x = index - row;
        if (x < 1 || y < 1 || x > grid.size_x || y > grid.size_y) continue;
        refused += !add({x, y, z, counts[index]});
      }
  }
  return refused;
}

}  // namespace rptv
