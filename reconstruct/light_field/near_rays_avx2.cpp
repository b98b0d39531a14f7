// SPDX-License-Identifier: MIT
// Rays near a point in AVX2: eight distances at once.
#include "reconstruct/light_field/near_rays_loops.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#include <bit>

namespace rptv {

namespace {

#define RPTV_AVX2 [[gnu::target("avx2")]]

struct Search8 {
  RPTV_AVX2 explicit Search8(const RaySearch& s) noexcept
      : x(_mm256_set1_ps(s.x)),
        y(_mm256_set1_ps(s.y)),
        z(_mm256_set1_ps(s.z)),
        cosine(_mm256_set1_ps(s.cosine)),
        sine(_mm256_set1_ps(s.sine)),
        reach(_mm256_set1_ps(s.reach)) {}

  // Eight rays become four columns, in the order 0 2 4 6 1 3 5 7; distances are in theirs.
  RPTV_AVX2 __m256 distances(const Ray* rays) const noexcept {
    const float* from = &rays->centre_x;
    const __m256 a = _mm256_loadu_ps(from), b = _mm256_loadu_ps(from + 8);
    const __m256 c = _mm256_loadu_ps(from + 16), d = _mm256_loadu_ps(from + 24);
    const __m256 centres_low = _mm256_shuffle_ps(a, b, 0x44), centres_high = _mm256_shuffle_ps(c, d, 0x44);
    const __m256 slopes_low = _mm256_shuffle_ps(a, b, 0xEE), slopes_high = _mm256_shuffle_ps(c, d, 0xEE);
    const __m256 centre_x = _mm256_shuffle_ps(centres_low, centres_high, 0x88);
    const __m256 centre_y = _mm256_shuffle_ps(centres_low, centres_high, 0xDD);
    const __m256 slope_x = _mm256_shuffle_ps(slopes_low, slopes_high, 0x88);
    const __m256 slope_y = _mm256_shuffle_ps(slopes_low, slopes_high, 0xDD);
    const __m256 r_x = _mm256_sub_ps(_mm256_add_ps(centre_x, _mm256_mul_ps(slope_x, z)), x);
    const __m256 r_y = _mm256_sub_ps(_mm256_add_ps(centre_y, _mm256_mul_ps(slope_y, z)), y);
    const __m256 along = _mm256_add_ps(_mm256_mul_ps(cosine, r_x), _mm256_mul_ps(sine, r_y));
    const __m256 across = _mm256_sub_ps(_mm256_mul_ps(cosine, r_y), _mm256_mul_ps(sine, r_x));
    const __m256 sign = _mm256_set1_ps(-0.0F);
    const __m256 mixed = _mm256_max_ps(_mm256_andnot_ps(sign, along), _mm256_andnot_ps(sign, across));
    return _mm256_permutevar8x32_ps(mixed, _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7));
  }
  RPTV_AVX2 unsigned inside(__m256 distance) const noexcept {
    return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(distance, reach, _CMP_LE_OQ)));
  }

  __m256 x, y, z, cosine, sine, reach;
};

RPTV_AVX2 std::size_t find(const Ray* rays, std::size_t first, std::size_t last, const RaySearch& s,
                           NearList near) noexcept {
  const Search8 search(s);
  std::size_t found = 0;
  for (; first + 8 <= last; first += 8) {
    const __m256 distance = search.distances(rays + first);
    float each[8];
    _mm256_storeu_ps(each, distance);
    for (unsigned inside = search.inside(distance); inside != 0; inside &= inside - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(inside));
      near.number[found] = static_cast<std::uint32_t>(first) + k;
      near.distance_mm[found++] = each[k];
    }
  }
  return found + kNearRayLoopsPlain.find(rays, first, last, s, {near.number + found, near.distance_mm + found});
}

RPTV_AVX2 void gather(const Ray* rays, const std::uint8_t* taken, std::size_t first, std::size_t last,
                      const RaySearch& s, RayColumns& near) noexcept {
  const Search8 search(s);
  for (; first + 8 <= last; first += 8)
    for (unsigned inside = search.inside(search.distances(rays + first)); inside != 0; inside &= inside - 1) {
      const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(inside));
      near.push_if(rays[i], taken[i] == 0);
    }
  kNearRayLoopsPlain.gather(rays, taken, first, last, s, near);
}

}  // namespace

const NearRayLoops kNearRayLoopsAvx2{find, gather, kNearRayLoopsPlain.keep};

}  // namespace rptv
#endif
