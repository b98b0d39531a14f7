// SPDX-License-Identifier: MIT
// Sixteen rays as columns of AVX-512 registers; for the files that are compiled for it.
#pragma once

#if defined(__x86_64__)
#if !defined(__clang__)  // GCC 12 warns of its own intrinsics (its bug 105593), also where they are inlined
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <immintrin.h>

#include <bit>
#include <cstddef>
#include <cstdint>

#include "reconstruct/light_field/rays.hpp"

namespace rptv {

#define RPTV_AVX512 [[gnu::target("avx512f,avx512bw,avx512vl,avx2,fma,popcnt")]]

struct Columns16 {
  __m512 centre_x, centre_y, slope_x, slope_y;
};

// `count` rays, 1 … 16, as columns; zeros behind them.
RPTV_AVX512 inline Columns16 columns_of(const Ray* rays, std::size_t count) noexcept {
  const __m512i even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
  const __m512i odd = _mm512_or_epi32(even, _mm512_set1_epi32(1));
  const std::uint64_t floats = ~std::uint64_t{0} >> (64 - 4 * count);
  const float* from = &rays->centre_x;
  const __m512 a = _mm512_maskz_loadu_ps(static_cast<__mmask16>(floats), from);
  const __m512 b = _mm512_maskz_loadu_ps(static_cast<__mmask16>(floats >> 16), from + 16);
  const __m512 c = _mm512_maskz_loadu_ps(static_cast<__mmask16>(floats >> 32), from + 32);
  const __m512 d = _mm512_maskz_loadu_ps(static_cast<__mmask16>(floats >> 48), from + 48);
  const __m512 xs_low = _mm512_permutex2var_ps(a, even, b), xs_high = _mm512_permutex2var_ps(c, even, d);
  const __m512 ys_low = _mm512_permutex2var_ps(a, odd, b), ys_high = _mm512_permutex2var_ps(c, odd, d);
  return {_mm512_permutex2var_ps(xs_low, even, xs_high), _mm512_permutex2var_ps(ys_low, even, ys_high),
          _mm512_permutex2var_ps(xs_low, odd, xs_high), _mm512_permutex2var_ps(ys_low, odd, ys_high)};
}

RPTV_AVX512 inline __mmask16 first_lanes(std::size_t count) noexcept {
  return static_cast<__mmask16>(0xFFFFU >> (16 - count));
}

RPTV_AVX512 inline std::size_t size_of(__mmask16 mask) noexcept {
  return static_cast<std::size_t>(std::popcount(static_cast<unsigned>(mask)));
}

// Those of the first `count` rays (1 … 16) that `taken` does not mark; all where it is null.
RPTV_AVX512 inline __mmask16 free_lanes(const std::uint8_t* taken, std::size_t count) noexcept {
  const __mmask16 real = first_lanes(count);
  if (taken == nullptr) return real;
  return _mm_mask_cmpeq_epi8_mask(real, _mm_maskz_loadu_epi8(real, taken), _mm_setzero_si128());
}

// Writes sixteen floats, of which those in `lanes` come first.
RPTV_AVX512 inline void store_packed(float* to, __mmask16 lanes, __m512 values) noexcept {
  _mm512_storeu_ps(to, _mm512_maskz_compress_ps(lanes, values));
}

}  // namespace rptv
#endif
