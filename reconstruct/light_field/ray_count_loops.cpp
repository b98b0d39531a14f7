// SPDX-License-Identifier: MIT
// The ray counter's loops in plain C++, compiled twice: fmaf() is one instruction where the processor has it and a
// slow, exact call where not.
#include "reconstruct/light_field/ray_count_loops.hpp"

#include <algorithm>

namespace rptv {

namespace {

#define RPTV_INLINE [[gnu::always_inline]] inline

RPTV_INLINE void load(const VoxelGrid& grid, std::span<const Ray> rays, std::span<const std::uint8_t> taken,
                      VoxelRays& out) noexcept {
  std::size_t n = 0;
  float slopes = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const VoxelRay ray = to_voxels(grid, rays[i]);
    out.column[n] = ray.column, out.row[n] = ray.row;
    out.column_slope[n] = ray.column_slope, out.row_slope[n] = ray.row_slope;
    const bool free = taken.empty() || taken[i] == 0;
    n += free ? 1 : 0;
    slopes += free ? fabsf(ray.column_slope) + fabsf(ray.row_slope) : 0.0F;
  }
  out.size = n, out.slope_sum = slopes;
  for (const std::size_t end = n + VoxelRays::kLanes - 1; n < end; ++n)
    out.column[n] = out.row[n] = out.column_slope[n] = out.row_slope[n] = 0;
}

RPTV_INLINE void find_on_plane(const VoxelGrid& grid, const VoxelRays& rays, std::size_t first, std::size_t count,
                               float z_mm, std::uint32_t* voxels) noexcept {
  for (std::size_t i = 0; i < count; ++i)
    voxels[i] = static_cast<std::uint32_t>(voxel_of(
        grid, {rays.column[first + i], rays.row[first + i], rays.column_slope[first + i], rays.row_slope[first + i]},
        z_mm));
}

void find_changes_portable(const VoxelGrid& grid, const VoxelRays& rays, std::size_t first, std::size_t last,
                           std::int32_t first_plane, std::size_t planes, VoxelChanges& changes) noexcept {
  std::array<std::uint32_t, VoxelChanges::kRays> even, odd;
  const std::size_t size = last - first;
  find_on_plane(grid, rays, first, size, grid.z_mm(first_plane), changes.first.data());
  const std::uint32_t* before = changes.first.data();
  for (std::size_t p = 1; p < planes; ++p) {
    std::uint32_t* now = p % 2 == 0 ? even.data() : odd.data();
    find_on_plane(grid, rays, first, size, grid.z_mm(first_plane + static_cast<std::int32_t>(p)), now);
    std::size_t count = 0;
    for (std::size_t i = 0; i < size; ++i) {  // without a branch: whether a ray moves is hard to guess
      changes.from[p][count] = before[i], changes.to[p][count] = now[i];
      count += before[i] != now[i];
    }
    changes.count[p] = count;
    before = now;
  }
}

RPTV_INLINE void find_voxels(const VoxelGrid& grid, const VoxelRays& rays, std::size_t first, std::size_t last,
                             std::int32_t first_plane, std::size_t planes, VoxelChanges& changes) noexcept {
  for (std::size_t p = 0; p < planes; ++p)
    find_on_plane(grid, rays, first, last - first, grid.z_mm(first_plane + static_cast<std::int32_t>(p)),
                  changes.to[p].data());
}

RPTV_INLINE std::uint32_t sum_and_mark(std::uint16_t* counts, const std::uint16_t* before, std::size_t size,
                                       std::uint16_t least, std::uint64_t* marks) noexcept {
  if (before != nullptr)
    for (std::size_t i = 0; i < size; ++i) counts[i] = static_cast<std::uint16_t>(counts[i] + before[i]);
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < size; ++i) sum += counts[i];
  for (std::size_t word = 0; word < size; word += 64, ++marks) {
    const std::size_t bits = std::min<std::size_t>(size - word, 64);
    std::uint16_t any = 0;
    for (std::size_t i = 0; i < bits; ++i) any |= static_cast<std::uint16_t>(counts[word + i] >= least);
    *marks = 0;
    if (any == 0) continue;  // almost everywhere
    for (std::size_t i = 0; i < bits; ++i) *marks |= std::uint64_t{counts[word + i] >= least} << i;
  }
  return sum;
}

// Those that the compiler makes vector code of, for one instruction set.
#define RPTV_LOOPS(SET, TARGET)                                                                                    \
  TARGET void load_##SET(const VoxelGrid& grid, std::span<const Ray> rays, std::span<const std::uint8_t> taken,    \
                         VoxelRays& out) noexcept {                                                                \
    load(grid, rays, taken, out);                                                                                  \
  }                                                                                                                \
  TARGET void find_voxels_##SET(const VoxelGrid& grid, const VoxelRays& rays, std::size_t first, std::size_t last, \
                                std::int32_t first_plane, std::size_t planes, VoxelChanges& changes) noexcept {    \
    find_voxels(grid, rays, first, last, first_plane, planes, changes);                                            \
  }                                                                                                                \
  TARGET std::uint32_t sum_and_mark_##SET(std::uint16_t* counts, const std::uint16_t* before, std::size_t size,    \
                                          std::uint16_t least, std::uint64_t* marks) noexcept {                    \
    return sum_and_mark(counts, before, size, least, marks);                                                       \
  }

RPTV_LOOPS(portable, )
constexpr RayCountLoops k_portable{load_portable, find_changes_portable, find_voxels_portable, sum_and_mark_portable};
#if defined(__x86_64__)
RPTV_LOOPS(avx2, [[gnu::target("avx2,fma")]])
constexpr RayCountLoops k_avx2{load_avx2, find_changes_avx2, find_voxels_avx2, sum_and_mark_avx2};
#endif

}  // namespace

const RayCountLoops& ray_count_loops(InstructionSet set) noexcept {
#if defined(__x86_64__)
  static const RayCountLoops k_avx512 = *ray_count_loops_avx512();
  if (set == InstructionSet::avx512) return k_avx512;
  if (set == InstructionSet::avx2) return k_avx2;
#endif
  static_cast<void>(set);
  return k_portable;
}

}  // namespace rptv
