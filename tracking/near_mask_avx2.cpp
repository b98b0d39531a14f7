// SPDX-License-Identifier: MIT
// The innermost arithmetic of the search in AVX2.
#include "tracking/near_mask.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace rptv {

#if defined(__x86_64__)
[[gnu::target("avx2")]] std::uint64_t near_in_rows_avx2(const double* x, const double* y, const double* z,
                                                        const Stretch* rows, std::size_t count, const Ellipsoid& e,
                                                        double* cost) noexcept {
  const __m256d centre_x = _mm256_set1_pd(e.x), centre_y = _mm256_set1_pd(e.y), centre_z = _mm256_set1_pd(e.z);
  const __m256d per_x = _mm256_set1_pd(e.per_x), per_y = _mm256_set1_pd(e.per_y), per_z = _mm256_set1_pd(e.per_z);
  const __m256d one = _mm256_set1_pd(1.0);
  std::uint64_t near = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const auto [begin, end] = rows[k];
    const __m256d dx = _mm256_mul_pd(_mm256_sub_pd(_mm256_loadu_pd(x + begin), centre_x), per_x);
    const __m256d dy = _mm256_mul_pd(_mm256_sub_pd(_mm256_loadu_pd(y + begin), centre_y), per_y);
    const __m256d dz = _mm256_mul_pd(_mm256_sub_pd(_mm256_loadu_pd(z + begin), centre_z), per_z);
    const __m256d xy = _mm256_add_pd(_mm256_mul_pd(dx, dx), _mm256_mul_pd(dy, dy));
    const __m256d sum = _mm256_add_pd(xy, _mm256_mul_pd(dz, dz));
    _mm256_storeu_pd(cost + 4 * k, sum);
    const auto mask = static_cast<std::uint32_t>(_mm256_movemask_pd(_mm256_cmp_pd(sum, one, _CMP_LE_OQ)));
    near |= std::uint64_t{mask & lanes(begin, end)} << (4 * k);
  }
  return near;
}
#else
std::uint64_t near_in_rows_avx2(const double* x, const double* y, const double* z, const Stretch* rows,
                                std::size_t count, const Ellipsoid& e, double* cost) noexcept {
  return near_in_rows(x, y, z, rows, count, e, cost);
}
#endif

}  // namespace rptv
