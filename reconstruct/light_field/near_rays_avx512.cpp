// SPDX-License-Identifier: MIT
// Rays near a point in AVX-512: sixteen distances at once, and those that are near are packed in the register.
#include "reconstruct/light_field/near_rays_loops.hpp"
#include "reconstruct/light_field/ray_columns_avx512.hpp"

#if defined(__x86_64__)
#include <algorithm>

namespace rptv {

namespace {

struct Search16 {
  RPTV_AVX512 explicit Search16(const RaySearch& s) noexcept
      : x(_mm512_set1_ps(s.x)),
        y(_mm512_set1_ps(s.y)),
        z(_mm512_set1_ps(s.z)),
        cosine(_mm512_set1_ps(s.cosine)),
        sine(_mm512_set1_ps(s.sine)),
        reach(_mm512_set1_ps(s.reach)) {}

  RPTV_AVX512 __m512 distances(const Columns16& rays) const noexcept {
    const __m512 r_x = _mm512_sub_ps(_mm512_add_ps(rays.centre_x, _mm512_mul_ps(rays.slope_x, z)), x);
    const __m512 r_y = _mm512_sub_ps(_mm512_add_ps(rays.centre_y, _mm512_mul_ps(rays.slope_y, z)), y);
    const __m512 along = _mm512_add_ps(_mm512_mul_ps(cosine, r_x), _mm512_mul_ps(sine, r_y));
    const __m512 across = _mm512_sub_ps(_mm512_mul_ps(cosine, r_y), _mm512_mul_ps(sine, r_x));
    return _mm512_max_ps(_mm512_abs_ps(along), _mm512_abs_ps(across));
  }
  RPTV_AVX512 __mmask16 inside(__m512 distance, __mmask16 among) const noexcept {
    return _mm512_mask_cmp_ps_mask(among, distance, reach, _CMP_LE_OQ);
  }

  __m512 x, y, z, cosine, sine, reach;
};

RPTV_AVX512 inline void append_packed(RayColumns& near, std::size_t at, __mmask16 lanes,
                                      const Columns16& rays) noexcept {
  store_packed(&near.centre_x[at], lanes, rays.centre_x);
  store_packed(&near.centre_y[at], lanes, rays.centre_y);
  store_packed(&near.slope_x[at], lanes, rays.slope_x);
  store_packed(&near.slope_y[at], lanes, rays.slope_y);
}

RPTV_AVX512 std::size_t find(const Ray* rays, std::size_t first, std::size_t last, const RaySearch& s,
                             NearList near) noexcept {
  const Search16 search(s);
  const __m512i counting = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  std::size_t found = 0;
  for (; first < last; first += 16) {
    const std::size_t count = std::min<std::size_t>(last - first, 16);
    const __m512 distance = search.distances(columns_of(rays + first, count));
    const __mmask16 inside = search.inside(distance, first_lanes(count));
    const __m512i number = _mm512_add_epi32(counting, _mm512_set1_epi32(static_cast<int>(first)));
    _mm512_storeu_si512(near.number + found, _mm512_maskz_compress_epi32(inside, number));
    store_packed(near.distance_mm + found, inside, distance);
    found += size_of(inside);
  }
  return found;
}

RPTV_AVX512 void gather(const Ray* rays, const std::uint8_t* taken, std::size_t first, std::size_t last,
                        const RaySearch& s, RayColumns& near) noexcept {
  const Search16 search(s);
  std::size_t size = near.size;
  for (; first < last; first += 16) {
    const std::size_t count = std::min<std::size_t>(last - first, 16);
    const __mmask16 free = free_lanes(taken + first, count);
    if (free == 0) continue;
    const Columns16 columns = columns_of(rays + first, count);
    const __mmask16 inside = search.inside(search.distances(columns), free);
    append_packed(near, size, inside, columns);
    size += size_of(inside);
  }
  near.size = size;
}

// In place: what is written has been read.
RPTV_AVX512 void keep(const RaySearch& s, RayColumns& near) noexcept {
  const Search16 search(s);
  std::size_t size = 0;
  for (std::size_t first = 0; first < near.size; first += 16) {
    const Columns16 columns{_mm512_loadu_ps(&near.centre_x[first]), _mm512_loadu_ps(&near.centre_y[first]),
                            _mm512_loadu_ps(&near.slope_x[first]), _mm512_loadu_ps(&near.slope_y[first])};
    const __mmask16 real = first_lanes(std::min<std::size_t>(near.size - first, 16));
    const __mmask16 inside = search.inside(search.distances(columns), real);
    append_packed(near, size, inside, columns);
    size += size_of(inside);
  }
  near.size = size;
}

}  // namespace

const NearRayLoops kNearRayLoopsAvx512{find, gather, keep};

}  // namespace rptv
#endif
