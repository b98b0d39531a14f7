// SPDX-License-Identifier: MIT
// The inner loops of the ray counter, compiled for several instruction sets. A ray leaves its voxel only every ten or
// thirty planes, so counting a group of planes is: count the first, note the changes, add them up from plane to plane.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/instruction_set.hpp"
#include "reconstruct/light_field/ray_count_kernel.hpp"

namespace rptv {

/// Rays in units of voxels as a structure of arrays with room for kLanes - 1 more behind the last one.
struct VoxelRays {
  static constexpr std::size_t kLanes = 16;
  float *column, *row, *column_slope, *row_slope;
  std::size_t size;
  float slope_sum;  ///< of |column_slope| + |row_slope|, voxels per mm
};

/// What a block of rays does on a group of planes: its voxels on the first plane, and on each further plane the moves
/// of those rays that are in another voxel than on the plane before.
struct VoxelChanges {
  static constexpr std::size_t kRays = 1024;  ///< in a block; a multiple of kLanes
  static constexpr std::size_t kPlanes = 16;  ///< in a group
  using List = std::array<std::uint32_t, kRays + VoxelRays::kLanes>;
  alignas(64) std::array<std::uint32_t, kRays> first;
  alignas(64) std::array<List, kPlanes> from, to;
  std::array<std::size_t, kPlanes> count;
};

/// One set of loops; all sets give the same integers. Nothing here allocates or throws.
struct RayCountLoops {
  /// Fills `out` with the rays that are free (`taken[ray] == 0`; empty: all), in their order, and pads.
  void (*load)(const VoxelGrid& grid, std::span<const Ray> rays, std::span<const std::uint8_t> taken,
               VoxelRays& out) noexcept;
  /// Changes of rays first … last - 1 (at most kRays; `first` a multiple of kLanes) on planes first_plane … + planes.
  void (*find_changes)(const VoxelGrid& grid, const VoxelRays& rays, std::size_t first, std::size_t last,
                       std::int32_t first_plane, std::size_t planes, VoxelChanges& changes) noexcept;
  /// Voxels of rays first … last - 1 on the same planes, all of them: into changes.to[p][0 … last - first - 1].
  void (*find_voxels)(const VoxelGrid& grid, const VoxelRays& rays, std::size_t first, std::size_t last,
                      std::int32_t first_plane, std::size_t planes, VoxelChanges& changes) noexcept;
  /// counts[i] += before[i] modulo 2^16 (unless `before` is null), and bit i of `marks` = counts[i] >= least. Returns
  /// the sum of these `size` counts.
  std::uint32_t (*sum_and_mark)(std::uint16_t* counts, const std::uint16_t* before, std::size_t size,
                                std::uint16_t least, std::uint64_t* marks) noexcept;
};

/// The loops for `set`, which the processor must have.
const RayCountLoops& ray_count_loops(InstructionSet set) noexcept;

/// Those in AVX-512; null on other architectures.
const RayCountLoops* ray_count_loops_avx512() noexcept;

#if defined(__x86_64__)
/// find_changes in AVX2.
void find_changes_avx2(const VoxelGrid& grid, const VoxelRays& rays, std::size_t first, std::size_t last,
                       std::int32_t first_plane, std::size_t planes, VoxelChanges& changes) noexcept;
#endif

}  // namespace rptv
