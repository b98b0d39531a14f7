// SPDX-License-Identifier: MIT
// Unpacking in AVX2: a byte shuffle puts each pixel into its word, a multiplication shifts each word by its own amount.
#include "acquisition/unpack_loops.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

namespace rptv {
namespace {

#define RPTV_AVX2 [[gnu::target("avx2")]]

template <class Table>
RPTV_AVX2 inline __m256i in_both_halves(const Table& table) noexcept {
  return _mm256_broadcastsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(table.data())));
}

// 8 pixels in each half. Reads 16 bytes from either, so the last few bytes of an image are left to the plain loop.
RPTV_AVX2 inline __m256i load(const std::byte* in, std::size_t bytes) noexcept {
  const __m128i first = _mm_loadu_si128(reinterpret_cast<const __m128i*>(in));
  const __m128i second = _mm_loadu_si128(reinterpret_cast<const __m128i*>(in + bytes));
  return _mm256_inserti128_si256(_mm256_castsi128_si256(first), second, 1);
}

RPTV_AVX2 inline void store(std::uint16_t* out, __m256i words) noexcept {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), words);
}

}  // namespace

RPTV_AVX2 std::size_t unpack_stream_avx2(const StreamLayout& layout, const std::byte* in, std::size_t in_bytes,
                                         std::uint16_t* out, std::size_t pixels) noexcept {
  const __m256i pair = in_both_halves(layout.pair), factor = in_both_halves(layout.factor);
  const __m128i down = _mm_cvtsi32_si128(static_cast<int>(16 - layout.bits));
  const std::size_t step = layout.bytes;
  std::size_t done = 0;
  for (std::size_t at = 0; done + 16 <= pixels && at + step + 16 <= in_bytes; done += 16, at += 2 * step) {
    const __m256i words = _mm256_shuffle_epi8(load(in + at, step), pair);
    store(out + done, _mm256_srl_epi16(_mm256_mullo_epi16(words, factor), down));
  }
  return done;
}

RPTV_AVX2 std::size_t unpack_split_avx2(const SplitLayout& layout, const std::byte* in, std::size_t in_bytes,
                                        std::uint16_t* out, std::size_t pixels) noexcept {
  const __m256i high = in_both_halves(layout.high), low = in_both_halves(layout.low);
  const __m256i factor = in_both_halves(layout.factor);
  const __m256i mask = _mm256_set1_epi16(static_cast<short>((1U << (layout.bits - 8)) - 1));
  const __m128i up = _mm_cvtsi32_si128(static_cast<int>(layout.bits - 8));
  const std::size_t step = layout.bytes;
  std::size_t done = 0;
  for (std::size_t at = 0; done + 16 <= pixels && at + step + 16 <= in_bytes; done += 16, at += 2 * step) {
    const __m256i bytes = load(in + at, step);
    const __m256i above = _mm256_sll_epi16(_mm256_shuffle_epi8(bytes, high), up);
    const __m256i shifted = _mm256_srli_epi16(_mm256_mullo_epi16(_mm256_shuffle_epi8(bytes, low), factor), 8);
    store(out + done, _mm256_or_si256(above, _mm256_and_si256(shifted, mask)));
  }
  return done;
}

}  // namespace rptv

#endif
