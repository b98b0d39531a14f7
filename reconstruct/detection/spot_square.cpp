// SPDX-License-Identifier: MIT
// Rows of eight pixels at once, compiled once per instruction set.
#include "reconstruct/detection/spot_square.hpp"

#include <array>
#include <cstring>

#include "reconstruct/detection/lanes.hpp"
#include "reconstruct/lit_mask.hpp"

namespace rptv {

namespace {

constexpr std::size_t kRow = SpotBatch::kRow;
using Row = float __attribute__((vector_size(kRow * sizeof(float))));
using RowBits = std::int32_t __attribute__((vector_size(kRow * sizeof(float))));

// Eight pixels as numbers. GCC 12 converts bytes one by one unless it is told how. Not returned: Clang refuses that
// between functions for different instruction sets.
struct RowLoad {
  template <class Pixel>
  static void load(const Pixel* pixels, Row& row) noexcept {
    for (std::size_t i = 0; i < kRow; ++i) row[i] = static_cast<float>(pixels[i]);
  }
};

#if defined(__x86_64__)
struct RowLoadAvx2 {
  RPTV_LIT_AVX2 static void load(const std::uint8_t* pixels, Row& row) noexcept {
    row = _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(pixels))));
  }
  RPTV_LIT_AVX2 static void load(const std::uint16_t* pixels, Row& row) noexcept {
    row = _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(pixels))));
  }
};
#endif

template <class Load, class Pixel>
RPTV_LANES SquareCounts copy(const GreyOverBackground<Pixel>& grey, PixelIndex middle, std::int32_t radius,
                             SpotBatch::Square& square) noexcept {
  const std::size_t side = 2 * static_cast<std::size_t>(radius) + 1;
  const Row dark = Row{} + grey.dark(grey.index(middle.x, middle.y)), saturation = Row{} + grey.saturation();
  RowBits lit{}, saturated{};
  std::size_t first = grey.index(middle.x - radius, middle.y - radius);
  for (std::size_t row = 0; row < side; ++row, first += static_cast<std::size_t>(grey.width())) {
    Row mean = Row{} + *grey.mean(first);
    if (!grey.one_background()) std::memcpy(&mean, grey.mean(first), sizeof mean);
    Row value;
    Load::load(grey.pixels() + first, value);
    const Row over = value - mean;
    lit -= over > dark, saturated -= value >= saturation;
    std::memcpy(square.data() + row * kRow, &over, sizeof over);
  }
  constexpr std::int32_t kShift = 8;  // both counts in one number: each is at most 49
  const RowBits columns{0, 1, 2, 3, 4, 5, 6, 7};
  RowBits both = (lit + (saturated << kShift)) & (columns < static_cast<std::int32_t>(side));
  both += __builtin_shufflevector(both, both, 4, 5, 6, 7, 0, 1, 2, 3);
  both += __builtin_shufflevector(both, both, 2, 3, 0, 1, 6, 7, 4, 5);
  const auto sum = static_cast<std::size_t>(both[0] + both[1]);
  return {sum & ((1U << kShift) - 1), sum >> kShift};
}

#define RPTV_COPY(SET, TARGET, LOAD)                                                                            \
  template <class Pixel>                                                                                        \
  TARGET SquareCounts copy_##SET(const GreyOverBackground<Pixel>& grey, PixelIndex middle, std::int32_t radius, \
                                 SpotBatch::Square& square) noexcept {                                          \
    return copy<LOAD>(grey, middle, radius, square);                                                            \
  }

RPTV_COPY(portable, , RowLoad)
#if defined(__x86_64__)
RPTV_COPY(avx2, RPTV_LIT_AVX2, RowLoadAvx2)
RPTV_COPY(avx512, RPTV_LIT_AVX512, RowLoadAvx2)
#endif

}  // namespace

template <class Pixel>
SquareCounts copy_square(const GreyOverBackground<Pixel>& grey, PixelIndex middle, std::int32_t radius,
                         SpotBatch::Square& square, InstructionSet set) noexcept {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return copy_avx512(grey, middle, radius, square);
  if (set == InstructionSet::avx2) return copy_avx2(grey, middle, radius, square);
#endif
  static_cast<void>(set);
  return copy_portable(grey, middle, radius, square);
}

template SquareCounts copy_square(const GreyOverBackground<std::uint8_t>&, PixelIndex, std::int32_t, SpotBatch::Square&,
                                  InstructionSet) noexcept;
template SquareCounts copy_square(const GreyOverBackground<std::uint16_t>&, PixelIndex, std::int32_t,
                                  SpotBatch::Square&, InstructionSet) noexcept;

}  // namespace rptv
