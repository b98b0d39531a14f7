// SPDX-License-Identifier: MIT
// 64 pixels against their limits, for each instruction set: bit i is set when pixels[i] > limits[i].
#pragma once

#include <cstddef>
#include <cstdint>

#if defined(__x86_64__)
#include <immintrin.h>
#define RPTV_LIT_AVX2 [[gnu::target("avx2,bmi")]]
#define RPTV_LIT_AVX512 [[gnu::target("avx512f,avx512bw,avx512vl,avx2,bmi")]]
#endif

namespace rptv {

/// Plain C++: the loop that tells whether any pixel is lit is vector code in any instruction set.
struct LitMask {
  template <class Pixel>
  static std::uint64_t above(const Pixel* pixels, const std::uint16_t* limits) noexcept {
    unsigned any = 0;
    for (std::size_t i = 0; i < 64; ++i) any |= static_cast<unsigned>(pixels[i] > limits[i]);
    if (any == 0) return 0;
    std::uint64_t mask = 0;
    for (std::size_t i = 0; i < 64; ++i) mask |= std::uint64_t{pixels[i] > limits[i]} << i;
    return mask;
  }
};

#if defined(__x86_64__)

struct LitMaskAvx2 {
  RPTV_LIT_AVX2 static __m256i dark16(__m256i pixels, const std::uint16_t* limits) noexcept {
    const __m256i limit = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(limits));
    return _mm256_cmpeq_epi16(_mm256_subs_epu16(pixels, limit), _mm256_setzero_si256());
  }
  RPTV_LIT_AVX2 static __m256i load16(const std::uint16_t* pixels) noexcept {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(pixels));
  }
  RPTV_LIT_AVX2 static __m256i load16(const std::uint8_t* pixels) noexcept {
    return _mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(pixels)));
  }
  template <class Pixel>
  RPTV_LIT_AVX2 static std::uint32_t above32(const Pixel* pixels, const std::uint16_t* limits) noexcept {
    const __m256i dark = _mm256_packs_epi16(dark16(load16(pixels), limits), dark16(load16(pixels + 16), limits + 16));
    return ~static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_permute4x64_epi64(dark, 0b11'01'10'00)));
  }
  template <class Pixel>
  RPTV_LIT_AVX2 static std::uint64_t above(const Pixel* pixels, const std::uint16_t* limits) noexcept {
    return above32(pixels, limits) | std::uint64_t{above32(pixels + 32, limits + 32)} << 32;
  }
};

struct LitMaskAvx512 {
  RPTV_LIT_AVX512 static __m512i load32(const std::uint16_t* pixels) noexcept { return _mm512_loadu_si512(pixels); }
  RPTV_LIT_AVX512 static __m512i load32(const std::uint8_t* pixels) noexcept {
    return _mm512_cvtepu8_epi16(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(pixels)));
  }
  template <class Pixel>
  RPTV_LIT_AVX512 static std::uint64_t above(const Pixel* pixels, const std::uint16_t* limits) noexcept {
    const std::uint64_t low = _mm512_cmpgt_epu16_mask(load32(pixels), _mm512_loadu_si512(limits));
    const std::uint64_t high = _mm512_cmpgt_epu16_mask(load32(pixels + 32), _mm512_loadu_si512(limits + 32));
    return low | high << 32;
  }
};

#endif

}  // namespace rptv
