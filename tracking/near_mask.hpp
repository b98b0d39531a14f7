// SPDX-License-Identifier: MIT
// Which of four neighbouring points are near: the innermost arithmetic of the search, two or four numbers at a time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace rptv {

/// Centre of a search and 1 / its half-axes.
struct Ellipsoid {
  double x, y, z;
  double per_x, per_y, per_z;
};

/// Costs ((x − centre) / half-axis)² summed over axes of four points, and one bit each for cost ≤ 1. Point by point, in
/// the same order of operations as near_mask(), which must agree bit for bit.
inline std::uint32_t near_mask_plain(const double* x, const double* y, const double* z, const Ellipsoid& e,
                                     double* cost) noexcept {
  std::uint32_t mask = 0;
  for (std::uint32_t k = 0; k < 4; ++k) {
    const double dx = (x[k] - e.x) * e.per_x;
    const double dy = (y[k] - e.y) * e.per_y;
    const double dz = (z[k] - e.z) * e.per_z;
    cost[k] = dx * dx + dy * dy + dz * dz;
    mask |= static_cast<std::uint32_t>(cost[k] <= 1.0) << k;
  }
  return mask;
}

inline std::uint32_t near_mask(const double* x, const double* y, const double* z, const Ellipsoid& e,
                               double* cost) noexcept {
#ifdef __SSE2__
  std::uint32_t mask = 0;
  for (int half = 0; half < 4; half += 2) {
    const __m128d dx = _mm_mul_pd(_mm_sub_pd(_mm_loadu_pd(x + half), _mm_set1_pd(e.x)), _mm_set1_pd(e.per_x));
    const __m128d dy = _mm_mul_pd(_mm_sub_pd(_mm_loadu_pd(y + half), _mm_set1_pd(e.y)), _mm_set1_pd(e.per_y));
    const __m128d dz = _mm_mul_pd(_mm_sub_pd(_mm_loadu_pd(z + half), _mm_set1_pd(e.z)), _mm_set1_pd(e.per_z));
    const __m128d sum = _mm_add_pd(_mm_add_pd(_mm_mul_pd(dx, dx), _mm_mul_pd(dy, dy)), _mm_mul_pd(dz, dz));
    _mm_storeu_pd(cost + half, sum);
    mask |= static_cast<std::uint32_t>(_mm_movemask_pd(_mm_cmple_pd(sum, _mm_set1_pd(1.0)))) << half;
  }
  return mask;
#else
  return near_mask_plain(x, y, z, e, cost);
#endif
}

/// Points begin … end − 1.
struct Stretch {
  std::uint32_t begin, end;
};

/// Bits for the points from `place` on that a stretch still has.
inline std::uint32_t lanes(std::uint32_t place, std::uint32_t end) noexcept {
  return (1U << std::min(end - place, 4U)) - 1U;
}

/// near_mask() of the first four points of each of up to 16 stretches: costs and bits 4 k … 4 k + 3 belong to stretch
/// k. Reads four points of each, whether it has them or not.
inline std::uint64_t near_in_rows(const double* x, const double* y, const double* z, const Stretch* rows,
                                  std::size_t count, const Ellipsoid& e, double* cost) noexcept {
  std::uint64_t near = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const auto [begin, end] = rows[k];
    const std::uint32_t mask = near_mask(x + begin, y + begin, z + begin, e, cost + 4 * k) & lanes(begin, end);
    near |= std::uint64_t{mask} << (4 * k);
  }
  return near;
}
/// The same, bit for bit, where InstructionSet::avx2 is there.
std::uint64_t near_in_rows_avx2(const double* x, const double* y, const double* z, const Stretch* rows,
                                std::size_t count, const Ellipsoid& e, double* cost) noexcept;

}  // namespace rptv
