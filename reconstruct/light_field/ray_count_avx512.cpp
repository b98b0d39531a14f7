// SPDX-License-Identifier: MIT
// The ray counter's loops in AVX-512: 16 rays side by side, and only those that change voxel are written out.
#include "reconstruct/light_field/ray_columns_avx512.hpp"
#include "reconstruct/light_field/ray_count_loops.hpp"

#if defined(__x86_64__)
#include <algorithm>
#include <numeric>

namespace rptv {

namespace {

struct Rays16 {
  __m512 column, row, column_slope, row_slope;
};

// nearest_voxel() for 16 rays: the second operand of max is what a NaN becomes.
RPTV_AVX512 inline __m512i nearest_voxels(__m512 position, __m512 slope, __m512 z_mm, __m512 last) noexcept {
  const __m512 at = _mm512_fmadd_ps(slope, z_mm, position);
  return _mm512_cvttps_epi32(_mm512_min_ps(_mm512_max_ps(at, _mm512_setzero_ps()), last));
}

struct Plane16 {
  __m512 last_column, last_row;
  __m512i stride;

  // voxel_of() for 16 rays.
  RPTV_AVX512 __m512i voxels_of(const Rays16& ray, __m512 z_mm) const noexcept {
    return _mm512_add_epi32(_mm512_mullo_epi32(nearest_voxels(ray.row, ray.row_slope, z_mm, last_row), stride),
                            nearest_voxels(ray.column, ray.column_slope, z_mm, last_column));
  }
};

RPTV_AVX512 Plane16 plane_of(const VoxelGrid& grid) noexcept {
  return {_mm512_set1_ps(static_cast<float>(grid.size_x + 1)), _mm512_set1_ps(static_cast<float>(grid.size_y + 1)),
          _mm512_set1_epi32(grid.stride())};
}

RPTV_AVX512 Rays16 load16(const VoxelRays& rays, std::size_t i) noexcept {
  return {_mm512_loadu_ps(rays.column + i), _mm512_loadu_ps(rays.row + i), _mm512_loadu_ps(rays.column_slope + i),
          _mm512_loadu_ps(rays.row_slope + i)};
}

// to_voxels() of the free ones.
RPTV_AVX512 void load(const VoxelGrid& grid, std::span<const Ray> rays, std::span<const std::uint8_t> taken,
                      VoxelRays& out) noexcept {
  const __m512 per_x = _mm512_set1_ps(1.0F / grid.step_x_mm), per_y = _mm512_set1_ps(1.0F / grid.step_y_mm);
  const __m512 first_x = _mm512_set1_ps(grid.first_x_mm), first_y = _mm512_set1_ps(grid.first_y_mm);
  const __m512 middle = _mm512_set1_ps(1.5F);
  __m512 slopes = _mm512_setzero_ps();
  std::size_t n = 0;
  for (std::size_t i = 0; i < rays.size(); i += 16) {
    const std::size_t count = std::min<std::size_t>(rays.size() - i, 16);
    const __mmask16 free = free_lanes(taken.empty() ? nullptr : &taken[i], count);
    const Columns16 ray = columns_of(&rays[i], count);
    const __m512 column_slope = _mm512_mul_ps(ray.slope_x, per_x), row_slope = _mm512_mul_ps(ray.slope_y, per_y);
    store_packed(out.column + n, free, _mm512_fmadd_ps(_mm512_sub_ps(ray.centre_x, first_x), per_x, middle));
    store_packed(out.row + n, free, _mm512_fmadd_ps(_mm512_sub_ps(ray.centre_y, first_y), per_y, middle));
    store_packed(out.column_slope + n, free, column_slope);
    store_packed(out.row_slope + n, free, row_slope);
    const __m512 slope = _mm512_add_ps(_mm512_abs_ps(column_slope), _mm512_abs_ps(row_slope));
    slopes = _mm512_mask_add_ps(slopes, free, slopes, slope);
    n += size_of(free);
  }
  out.size = n, out.slope_sum = _mm512_reduce_add_ps(slopes);
  for (float* column : {out.column, out.row, out.column_slope, out.row_slope})
    std::fill_n(column + n, VoxelRays::kLanes - 1, 0.0F);
}

struct Depths {
  std::array<float, VoxelChanges::kPlanes> z_mm;
  Depths(const VoxelGrid& grid, std::int32_t first_plane, std::size_t planes) noexcept {
    for (std::size_t p = 0; p < planes; ++p) z_mm[p] = grid.z_mm(first_plane + static_cast<std::int32_t>(p));
  }
};

RPTV_AVX512 void find_changes(const VoxelGrid& grid, const VoxelRays& rays, std::size_t first, std::size_t last,
                              std::int32_t first_plane, std::size_t planes, VoxelChanges& changes) noexcept {
  const Plane16 plane = plane_of(grid);
  const Depths at(grid, first_plane, planes);
  changes.count.fill(0);
  for (std::size_t i = first; i < last; i += VoxelRays::kLanes) {
    const Rays16 ray = load16(rays, i);
    __m512i before = plane.voxels_of(ray, _mm512_set1_ps(at.z_mm[0]));
    _mm512_store_si512(changes.first.data() + (i - first), before);
    for (std::size_t p = 1; p < planes; ++p) {
      const __m512i now = plane.voxels_of(ray, _mm512_set1_ps(at.z_mm[p]));
      const __mmask16 moved = _mm512_cmpneq_epi32_mask(now, before);
      std::size_t& count = changes.count[p];
      _mm512_storeu_si512(changes.from[p].data() + count, _mm512_maskz_compress_epi32(moved, before));
      _mm512_storeu_si512(changes.to[p].data() + count, _mm512_maskz_compress_epi32(moved, now));
      count += size_of(moved);
      before = now;
    }
  }
}

RPTV_AVX512 void find_voxels(const VoxelGrid& grid, const VoxelRays& rays, std::size_t first, std::size_t last,
                             std::int32_t first_plane, std::size_t planes, VoxelChanges& changes) noexcept {
  const Plane16 plane = plane_of(grid);
  const Depths at(grid, first_plane, planes);
  for (std::size_t i = first; i < last; i += VoxelRays::kLanes) {
    const Rays16 ray = load16(rays, i);
    for (std::size_t p = 0; p < planes; ++p)
      _mm512_storeu_si512(changes.to[p].data() + (i - first), plane.voxels_of(ray, _mm512_set1_ps(at.z_mm[p])));
  }
}

// Up to 32 counters: add, store, compare; their sum goes into `sums`.
RPTV_AVX512 inline std::uint64_t mark(std::uint16_t* counts, const std::uint16_t* before, std::size_t size,
                                      __m512i least, __m512i& sums) noexcept {
  const auto present = static_cast<__mmask32>(size >= 32 ? ~0U : (1U << size) - 1);
  __m512i count = _mm512_maskz_loadu_epi16(present, counts);
  if (before != nullptr) {
    count = _mm512_add_epi16(count, _mm512_maskz_loadu_epi16(present, before));
    _mm512_mask_storeu_epi16(counts, present, count);
  }
  const __m512i odd = _mm512_srli_epi32(count, 16), even = _mm512_and_epi32(count, _mm512_set1_epi32(0xffff));
  sums = _mm512_add_epi32(sums, _mm512_add_epi32(odd, even));
  return _mm512_mask_cmpge_epu16_mask(present, count, least);
}

RPTV_AVX512 std::uint32_t sum_and_mark(std::uint16_t* counts, const std::uint16_t* before, std::size_t size,
                                       std::uint16_t least, std::uint64_t* marks) noexcept {
  const __m512i at_least = _mm512_set1_epi16(static_cast<short>(least));
  __m512i sums = _mm512_setzero_si512();
  for (std::size_t i = 0; i < size; i += 64) {
    const std::uint16_t* other = before == nullptr ? nullptr : before + i;
    *marks = mark(counts + i, other, size - i, at_least, sums);
    if (size - i > 32)
      *marks |= mark(counts + i + 32, other == nullptr ? nullptr : other + 32, size - i - 32, at_least, sums) << 32;
    ++marks;
  }
  alignas(64) std::array<std::uint32_t, 16> lanes;
  _mm512_store_si512(lanes.data(), sums);
  return std::accumulate(lanes.begin(), lanes.end(), 0U);
}

}  // namespace

const RayCountLoops* ray_count_loops_avx512() noexcept {
  static constexpr RayCountLoops kLoops{load, find_changes, find_voxels, sum_and_mark};
  return &kLoops;
}

}  // namespace rptv

#else

namespace rptv {
const RayCountLoops* ray_count_loops_avx512() noexcept { return nullptr; }
}  // namespace rptv

#endif
