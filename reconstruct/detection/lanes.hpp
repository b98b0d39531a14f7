// SPDX-License-Identifier: MIT
// Several numbers at once in plain arithmetic: the compiler makes of it what the instruction set at hand has. Or one, a
// float, which is what a thread of a GPU has.
#pragma once

#include <cstddef>
#include <cstdint>

#include "reconstruct/detection/lane_bits.hpp"

namespace rptv {

/// Element by element; every set of instructions gives the same bits (no contraction, no library function).
/// Sources that use it are compiled with -Wno-psabi: lanes are passed to inlined functions only.
/// As many as a register holds are quickest; GCC 12 takes wider ones apart through memory, and knows sizes that depend
/// on an argument in a typedef only.
template <std::size_t kCount>
struct LaneTypes {
  typedef float Lanes __attribute__((vector_size(kCount * sizeof(float))));
  typedef std::int32_t Bits __attribute__((vector_size(kCount * sizeof(float))));  ///< also truth: 0 or -1
};

template <class Lanes>
RPTV_LANES Lanes least(Lanes a, Lanes b) noexcept {
  return b < a ? b : a;
}
template <class Lanes>
RPTV_LANES Lanes most(Lanes a, Lanes b) noexcept {
  return a < b ? b : a;
}
/// Natural logarithm of positive, normal numbers, within 1e-7 of it or of 1: twice the area tangent's series of
/// (m - 1)/(m + 1) for the mantissa m between √½ and √2.
template <class Lanes>
RPTV_LANES Lanes log_of(Lanes x) noexcept {
  using Bits = decltype(bits_of(x));
  constexpr std::int32_t kRootHalf = 0x3F3504F3;  // √½
  constexpr float kLn2 = 0.69314718F;
  const Bits bits = bits_of(x);
  const Bits exponent = (bits - kRootHalf) >> 23;
  const Lanes m = from_bits<Lanes>(bits - shifted_by_23(exponent));
  const Lanes s = (m - 1.0F) / (m + 1.0F), s2 = s * s;
  const Lanes series = ((s2 * (1 / 7.0F) + 1 / 5.0F) * s2 + 1 / 3.0F) * s2;
  return converted<Lanes>(exponent) * kLn2 + (s + s * series) * 2.0F;
}

/// Exponential, within 3e-7 of itself, of numbers clamped to ±80.
template <class Lanes>
RPTV_LANES Lanes exp_of(Lanes x) noexcept {
  using Bits = decltype(bits_of(x));
  constexpr float kPerLn2 = 1.44269504F, kLn2High = 0.693359375F, kLn2Low = -2.12194440e-4F;
  constexpr float kRound = 12582912.0F;  // 1.5·2²³: adding it leaves an integer in the low bits
  x = least(most(x, Lanes{} - 80.0F), Lanes{} + 80.0F);
  const Lanes shifted = x * kPerLn2 + kRound, n = shifted - kRound;
  const Lanes r = (x - n * kLn2High) - n * kLn2Low;
  Lanes power = (r * (1 / 720.0F) + 1 / 120.0F) * r + 1 / 24.0F;
  power = ((power * r + 1 / 6.0F) * r + 1 / 2.0F) * r + 1.0F;
  power = power * r + 1.0F;
  return from_bits<Lanes>(bits_of(power) + shifted_by_23(converted<Bits>(n)));
}

}  // namespace rptv
