// SPDX-License-Identifier: MIT
// The ray counter matrix C(x, y, z) of eq. (6) on the CPU.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reconstruct/ray_count_kernel.hpp"

namespace rptv {

/// Counts are 16 bit and stop at 65535. All memory is taken by the constructor; one thread calls, `threads` count.
class RayCounter {
 public:
  RayCounter(const VoxelGrid& grid, std::size_t max_rays, std::size_t threads);

  /// Clears all counters and counts those rays whose pixel is free (`taken[pixel] == 0`); an empty `taken` counts all.
  void count(const Rays& rays, std::span<const std::uint8_t> taken) noexcept;

  const VoxelGrid& grid() const noexcept { return grid_; }
  std::span<const std::uint16_t> plane(std::int32_t z) const noexcept {
    const auto size = static_cast<std::size_t>(grid_.plane_size());
    return {counts_.data() + static_cast<std::size_t>(z) * size, size};
  }
  std::uint16_t at(std::int32_t x, std::int32_t y, std::int32_t z) const noexcept {
    return plane(z)[static_cast<std::size_t>(grid_.index(x, y))];
  }

 private:
  const VoxelGrid grid_;
  const std::size_t threads_;
  std::size_t rays_ = 0;
  std::vector<float> column_, row_, column_slope_, row_slope_;
  std::vector<std::uint16_t> counts_;
};

}  // namespace rptv
