// SPDX-License-Identifier: MIT
// The ray counter matrix C(x, y, z) of eq. (6) on the CPU, and which of its voxels have C_min rays, eq. (7).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reconstruct/light_field/ray_count_loops.hpp"
#include "reconstruct/light_field/rays.hpp"

namespace rptv {

/// Counts are 16 bit and stop at 65535. All memory is taken by the constructor; one thread calls, `threads` count.
class RayCounter {
 public:
  RayCounter(const VoxelGrid& grid, std::size_t max_rays, std::size_t threads,
             InstructionSet set = best_instruction_set());
  RayCounter(RayCounter&&) noexcept = default;  // not copied: rays_ points into ray_memory_

  /// Clears all counters, counts those rays that are free (`taken[ray] == 0`; an empty `taken` counts all), and
  /// marks the voxels that at least `least` rays go through.
  void count(const Rays& rays, std::span<const std::uint8_t> taken, std::uint16_t least) noexcept;

  const VoxelGrid& grid() const noexcept { return grid_; }
  std::span<const std::uint16_t> plane(std::int32_t z) const noexcept {
    return {counts_.data() + static_cast<std::size_t>(z) * plane_size_, plane_size_};
  }
  std::uint16_t at(std::int32_t x, std::int32_t y, std::int32_t z) const noexcept {
    return plane(z)[static_cast<std::size_t>(grid_.index(x, y))];
  }
  /// One bit for each counter of a plane, border included, lowest bit first.
  std::span<const std::uint64_t> marks(std::int32_t z) const noexcept {
    return {marks_.data() + static_cast<std::size_t>(z) * plane_words_, plane_words_};
  }

 private:
  void count_group(std::size_t group, VoxelChanges& changes, std::uint16_t least) noexcept;
  void add_changes(const VoxelChanges& changes, std::size_t rays, std::size_t planes,
                   std::uint16_t* counts) const noexcept;
  void add_voxels(const VoxelChanges& changes, std::size_t rays, std::size_t planes,
                  std::uint16_t* counts) const noexcept;
  void sum_group(std::size_t first_plane, std::size_t planes, std::uint16_t least, bool differences) noexcept;
  void count_saturating(std::size_t plane, std::uint16_t least) noexcept;

  const VoxelGrid grid_;
  const std::size_t plane_size_, plane_words_, group_planes_;
  const RayCountLoops& loops_;
  VoxelRays rays_{};
  std::vector<float> ray_memory_;
  std::vector<std::uint16_t> counts_;
  std::vector<std::uint64_t> marks_;
  std::vector<VoxelChanges> changes_;  // one per thread
};

}  // namespace rptv
