// SPDX-License-Identifier: MIT
// Columns compared one by one, eight or sixteen at once.
#include "reconstruct/detection/near_columns.hpp"

#include "reconstruct/lit_mask.hpp"

namespace rptv {

namespace {

// Also for those that no longer fill a register, from number `from` on.
[[gnu::always_inline]] inline std::uint64_t near_singly(const PixelIndex* pixels, std::size_t from, std::size_t count,
                                                        std::int32_t x, std::int32_t reach) noexcept {
  std::uint64_t near = 0;
  for (std::size_t k = from; k < count; ++k) {
    const auto after_first = static_cast<std::uint32_t>(pixels[k].x - x + reach);
    near |= std::uint64_t{after_first <= static_cast<std::uint32_t>(2 * reach)} << k;
  }
  return near;
}

std::uint64_t near_portable(const PixelIndex* pixels, std::size_t count, std::int32_t x, std::int32_t reach) noexcept {
  return near_singly(pixels, 0, count, x, reach);
}

#if defined(__x86_64__)

RPTV_LIT_AVX2 std::uint64_t near_avx2(const PixelIndex* pixels, std::size_t count, std::int32_t x,
                                      std::int32_t reach) noexcept {
  const __m256i first = _mm256_set1_epi32(x - reach - 1), last = _mm256_set1_epi32(x + reach);
  std::uint64_t near = 0;
  std::size_t k = 0;
  for (; k + 8 <= count; k += 8) {
    const __m256 low = _mm256_loadu_ps(reinterpret_cast<const float*>(pixels + k));
    const __m256 high = _mm256_loadu_ps(reinterpret_cast<const float*>(pixels + k + 4));
    const __m256i pairs = _mm256_castps_si256(_mm256_shuffle_ps(low, high, 0b10'00'10'00));  // 0 1 4 5, 2 3 6 7
    const __m256i columns = _mm256_permute4x64_epi64(pairs, 0b11'01'10'00);
    const __m256i in = _mm256_andnot_si256(_mm256_cmpgt_epi32(columns, last), _mm256_cmpgt_epi32(columns, first));
    near |= std::uint64_t{static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(in)))} << k;
  }
  return near | near_singly(pixels, k, count, x, reach);
}

RPTV_LIT_AVX512 std::uint64_t near_avx512(const PixelIndex* pixels, std::size_t count, std::int32_t x,
                                          std::int32_t reach) noexcept {
  const __m512i even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
  const __m512i first = _mm512_set1_epi32(x - reach), most = _mm512_set1_epi32(2 * reach);
  std::uint64_t near = 0;
  for (std::size_t k = 0; k < count; k += 16) {
    const std::size_t numbers = 2 * (count - k);  // a column and a row each
    const auto there = numbers >= 32 ? ~std::uint32_t{0} : (std::uint32_t{1} << numbers) - 1;
    const __m512i low = _mm512_maskz_loadu_epi32(static_cast<__mmask16>(there), pixels + k);
    const __m512i high = _mm512_maskz_loadu_epi32(static_cast<__mmask16>(there >> 16), pixels + k + 8);
    const __m512i after_first = _mm512_sub_epi32(_mm512_permutex2var_epi32(low, even, high), first);
    near |= std::uint64_t{_mm512_cmple_epu32_mask(after_first, most)} << k;
  }
  return count < 64 ? near & ((std::uint64_t{1} << count) - 1) : near;
}

#endif

}  // namespace

NearColumns near_columns(InstructionSet set) noexcept {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return near_avx512;
  if (set == InstructionSet::avx2) return near_avx2;
#endif
  static_cast<void>(set);
  return near_portable;
}

}  // namespace rptv
