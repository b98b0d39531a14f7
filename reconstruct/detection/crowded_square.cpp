// SPDX-License-Identifier: MIT
// Gaussians as products of a row and a column of exponentials, eight at once; compiled once per instruction set.
#include "reconstruct/detection/crowded_square.hpp"

#include <cstring>

#include "reconstruct/detection/lanes.hpp"
#include "reconstruct/lit_mask.hpp"

namespace rptv {

namespace {

constexpr std::size_t kRow = SpotBatch::kRow;
using Light = LaneTypes<kRow>::Lanes;

// Exponentials of a Gaussian of height 1 along eight pixels, of which the first is `first_off` px from its middle.
RPTV_LANES void profile(double first_off, float bend, Light& values) noexcept {
  const Light off = Light{0, 1, 2, 3, 4, 5, 6, 7} + static_cast<float>(first_off);
  values = exp_of(off * off * bend);
}

struct Profiles {
  RPTV_LANES Profiles(const FittedSpot& spot, PixelIndex corner) noexcept {
    profile(corner.x - spot.x_px, spot.bend, along_x);
    profile(corner.y - spot.y_px, spot.bend, along_y);
    along_y *= spot.peak;
  }
  Light along_x, along_y;
};

RPTV_LANES void light(std::span<const FittedSpot> spots, std::size_t i, std::span<const std::uint32_t> neighbours,
                      std::int32_t radius, const GreyNoise& noise, CrowdedSquare& square) noexcept {
  const PixelIndex middle = spots[i].middle(), corner{middle.x - radius, middle.y - radius};
  const auto side = static_cast<std::size_t>(2 * radius + 1);
  std::array<Light, 2 * SpotBatch::kMostRadius + 1> others{};
  for (const std::uint32_t k : neighbours) {
    const Profiles other(spots[k], corner);
    for (std::size_t row = 0; row < side; ++row) others[row] += other.along_x * other.along_y[row];
  }
  const Profiles own(spots[i], corner);
  Light others_sum{}, variance_sum{};
  for (std::size_t row = 0; row < side; ++row) {
    const Light alone = own.along_x * own.along_y[row] * noise.grey_per_electron + noise.dark_variance;
    const Light all = alone + others[row] * noise.grey_per_electron, weight = alone / all;
    others_sum += others[row], variance_sum += all;
    std::memcpy(square.others.data() + row * kRow, &others[row], sizeof all);
    std::memcpy(square.weight.data() + row * kRow, &weight, sizeof weight);
  }
  square.others_sum = square.variance_sum = 0;
  for (std::size_t column = 0; column < side; ++column)
    square.others_sum += others_sum[column], square.variance_sum += variance_sum[column];
}

#define RPTV_LIGHT(SET, TARGET)                                                                                        \
  TARGET void light_##SET(std::span<const FittedSpot> spots, std::size_t i, std::span<const std::uint32_t> neighbours, \
                          std::int32_t radius, const GreyNoise& noise, CrowdedSquare& square) noexcept {               \
    light(spots, i, neighbours, radius, noise, square);                                                                \
  }

RPTV_LIGHT(portable, )
#if defined(__x86_64__)
RPTV_LIGHT(avx2, RPTV_LIT_AVX2)
RPTV_LIGHT(avx512, RPTV_LIT_AVX512)
#endif

}  // namespace

void light_crowded_square(std::span<const FittedSpot> spots, std::size_t i, std::span<const std::uint32_t> neighbours,
                          std::int32_t radius, const GreyNoise& noise, CrowdedSquare& square,
                          InstructionSet set) noexcept {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return light_avx512(spots, i, neighbours, radius, noise, square);
  if (set == InstructionSet::avx2) return light_avx2(spots, i, neighbours, radius, noise, square);
#endif
  static_cast<void>(set);
  light_portable(spots, i, neighbours, radius, noise, square);
}

}  // namespace rptv
