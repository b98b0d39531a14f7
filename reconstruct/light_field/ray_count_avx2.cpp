// SPDX-License-Identifier: MIT
// The search for rays that change voxel in AVX2: 8 rays side by side, and a table that moves those that do to the
// front.
#include "reconstruct/light_field/ray_count_loops.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#include <bit>

namespace rptv {

namespace {

#define RPTV_AVX2 [[gnu::target("avx2,fma")]]

// Row m: the numbers of the bits that are set in m, one after the other.
constexpr auto kToFront = [] {
  std::array<std::array<std::uint8_t, 8>, 256> table{};
  for (unsigned mask = 0; mask < 256; ++mask)
    for (std::uint8_t bit = 0, next = 0; bit < 8; ++bit)
      if ((mask >> bit & 1U) != 0) table[mask][next++] = bit;
  return table;
}();

struct Rays8 {
  __m256 column, row, column_slope, row_slope;
};

struct Plane8 {
  __m256 last_column, last_row;
  __m256i stride;

  // nearest_voxel() for 8 rays: the second operand of max is what a NaN becomes.
  RPTV_AVX2 static __m256i nearest(__m256 position, __m256 slope, __m256 z_mm, __m256 last) noexcept {
    const __m256 at = _mm256_fmadd_ps(slope, z_mm, position);
    return _mm256_cvttps_epi32(_mm256_min_ps(_mm256_max_ps(at, _mm256_setzero_ps()), last));
  }
  RPTV_AVX2 __m256i voxels_of(const Rays8& ray, __m256 z_mm) const noexcept {
    return _mm256_add_epi32(_mm256_mullo_epi32(nearest(ray.row, ray.row_slope, z_mm, last_row), stride),
                            nearest(ray.column, ray.column_slope, z_mm, last_column));
  }
};

RPTV_AVX2 inline void store(std::uint32_t* to, __m256i eight) noexcept {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), eight);
}

}  // namespace

RPTV_AVX2 void find_changes_avx2(const VoxelGrid& grid, const VoxelRays& rays, std::size_t first, std::size_t last,
                                 std::int32_t first_plane, std::size_t planes, VoxelChanges& changes) noexcept {
  const Plane8 plane{_mm256_set1_ps(static_cast<float>(grid.size_x + 1)),
                     _mm256_set1_ps(static_cast<float>(grid.size_y + 1)), _mm256_set1_epi32(grid.stride())};
  std::array<float, VoxelChanges::kPlanes> z_mm{};
  for (std::size_t p = 0; p < planes; ++p) z_mm[p] = grid.z_mm(first_plane + static_cast<std::int32_t>(p));
  changes.count.fill(0);
  for (std::size_t i = first; i < last; i += 8) {
    const Rays8 ray{_mm256_loadu_ps(rays.column + i), _mm256_loadu_ps(rays.row + i),
                    _mm256_loadu_ps(rays.column_slope + i), _mm256_loadu_ps(rays.row_slope + i)};
    __m256i before = plane.voxels_of(ray, _mm256_set1_ps(z_mm[0]));
    store(changes.first.data() + (i - first), before);
    for (std::size_t p = 1; p < planes; ++p) {
      const __m256i now = plane.voxels_of(ray, _mm256_set1_ps(z_mm[p]));
      const auto still =
          static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpeq_epi32(now, before))));
      const unsigned moved = ~still & 0xffU;
      const __m256i order =
          _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(kToFront[moved].data())));
      std::size_t& count = changes.count[p];
      store(changes.from[p].data() + count, _mm256_permutevar8x32_epi32(before, order));
      store(changes.to[p].data() + count, _mm256_permutevar8x32_epi32(now, order));
      count += static_cast<std::size_t>(std::popcount(moved));
      before = now;
    }
  }
}

}  // namespace rptv

#endif
