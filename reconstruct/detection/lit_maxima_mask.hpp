// SPDX-License-Identifier: MIT
// 64 pixels against their eight neighbours, for each instruction set: bit i is set when pixel i is a local maximum.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "reconstruct/detection/lit_maximum_kernel.hpp"
#include "reconstruct/lit_mask.hpp"

namespace rptv {

/// `among(lit, …)` gives those of the 64 pixels from `pixels` on that are set in `lit` and are maxima.
struct MaximaMask {
  template <class Pixel>
  static std::uint64_t among(std::uint64_t lit, const Pixel* pixels, std::ptrdiff_t stride) noexcept {
    std::uint64_t mask = 0;
    for (; lit != 0; lit &= lit - 1) {
      const int i = std::countr_zero(lit);
      mask |= std::uint64_t{is_maximum(pixels + i, stride)} << i;
    }
    return mask;
  }
};

#if defined(__x86_64__)

struct MaximaMaskAvx2 {
  RPTV_LIT_AVX2 static __m256i load(const void* at) noexcept {
    return _mm256_loadu_si256(static_cast<const __m256i*>(at));
  }
  template <class Pixel>
  RPTV_LIT_AVX2 static __m256i larger(__m256i a, __m256i b) noexcept {
    return sizeof(Pixel) == 1 ? _mm256_max_epu8(a, b) : _mm256_max_epu16(a, b);
  }
  template <class Pixel>
  RPTV_LIT_AVX2 static __m256i equal(__m256i a, __m256i b) noexcept {
    return sizeof(Pixel) == 1 ? _mm256_cmpeq_epi8(a, b) : _mm256_cmpeq_epi16(a, b);
  }
  // All bits set in each pixel of 32 bytes that is a maximum.
  template <class Pixel>
  RPTV_LIT_AVX2 static __m256i maxima(const Pixel* p, std::ptrdiff_t stride) noexcept {
    const __m256i middle = load(p);
    const __m256i above = larger<Pixel>(larger<Pixel>(load(p - stride - 1), load(p - stride)), load(p - stride + 1));
    const __m256i below = larger<Pixel>(larger<Pixel>(load(p + stride - 1), load(p + stride)), load(p + stride + 1));
    const __m256i before = larger<Pixel>(above, load(p - 1)), after = larger<Pixel>(below, load(p + 1));
    const __m256i not_above = equal<Pixel>(larger<Pixel>(before, middle), before);  // before ≥ middle
    return _mm256_andnot_si256(not_above, equal<Pixel>(larger<Pixel>(after, middle), middle));
  }
  RPTV_LIT_AVX2 static std::uint32_t bits(__m256i bytes) noexcept {
    return static_cast<std::uint32_t>(_mm256_movemask_epi8(bytes));
  }
  RPTV_LIT_AVX2 static std::uint64_t among(std::uint64_t lit, const std::uint8_t* p, std::ptrdiff_t stride) noexcept {
    return lit & (bits(maxima(p, stride)) | std::uint64_t{bits(maxima(p + 32, stride))} << 32);
  }
  RPTV_LIT_AVX2 static std::uint32_t of32(const std::uint16_t* p, std::ptrdiff_t stride) noexcept {
    return bits(_mm256_permute4x64_epi64(_mm256_packs_epi16(maxima(p, stride), maxima(p + 16, stride)), 0b11'01'10'00));
  }
  RPTV_LIT_AVX2 static std::uint64_t among(std::uint64_t lit, const std::uint16_t* p, std::ptrdiff_t stride) noexcept {
    return lit & (of32(p, stride) | std::uint64_t{of32(p + 32, stride)} << 32);
  }
};

struct MaximaMaskAvx512 {
  RPTV_LIT_AVX512 static __m512i load(const void* at) noexcept { return _mm512_loadu_si512(at); }
  RPTV_LIT_AVX512 static std::uint64_t among(std::uint64_t lit, const std::uint8_t* p, std::ptrdiff_t s) noexcept {
    const __m512i above = _mm512_max_epu8(_mm512_max_epu8(load(p - s - 1), load(p - s)), load(p - s + 1));
    const __m512i below = _mm512_max_epu8(_mm512_max_epu8(load(p + s - 1), load(p + s)), load(p + s + 1));
    const __m512i before = _mm512_max_epu8(above, load(p - 1)), after = _mm512_max_epu8(below, load(p + 1));
    return _mm512_mask_cmpgt_epu8_mask(_mm512_mask_cmpge_epu8_mask(lit, load(p), after), load(p), before);
  }
  RPTV_LIT_AVX512 static std::uint32_t of32(const std::uint16_t* p, std::ptrdiff_t s) noexcept {
    const __m512i above = _mm512_max_epu16(_mm512_max_epu16(load(p - s - 1), load(p - s)), load(p - s + 1));
    const __m512i below = _mm512_max_epu16(_mm512_max_epu16(load(p + s - 1), load(p + s)), load(p + s + 1));
    const __m512i before = _mm512_max_epu16(above, load(p - 1)), after = _mm512_max_epu16(below, load(p + 1));
    return _mm512_mask_cmpgt_epu16_mask(_mm512_cmpge_epu16_mask(load(p), after), load(p), before);
  }
  RPTV_LIT_AVX512 static std::uint64_t among(std::uint64_t lit, const std::uint16_t* p, std::ptrdiff_t s) noexcept {
    return lit & (of32(p, s) | std::uint64_t{of32(p + 32, s)} << 32);
  }
};

#endif

}  // namespace rptv
