// SPDX-License-Identifier: MIT
// Comparisons and bits of several floats at once, or of one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "reconstruct/host_device.hpp"

#define RPTV_LANES [[gnu::always_inline]] RPTV_HOST_DEVICE inline

// Before a loop of seven turns at most, whose number is known where it is inlined.
#if defined(__GNUC__) && !defined(__clang__) && !defined(__CUDACC__)
#define RPTV_UNROLL _Pragma("GCC unroll 7")
#else
#define RPTV_UNROLL
#endif

namespace rptv {

/// Of comparisons: 0 or -1 in each lane; false or true of one number.
template <class Lanes>
using LaneTruth = decltype(Lanes{} < Lanes{});

template <class Bits>
RPTV_LANES bool any(Bits truth) noexcept {
  std::int32_t together = 0;
  for (std::size_t i = 0; i < sizeof truth / sizeof together; ++i) together |= truth[i];
  return together != 0;
}
RPTV_LANES bool any(bool truth) noexcept { return truth; }

// The bits of a float as an integer and back, their numbers as each other, and 2²³ of them.
template <class Lanes>
RPTV_LANES auto bits_of(Lanes x) noexcept {
  return reinterpret_cast<LaneTruth<Lanes>>(x);
}
RPTV_LANES std::int32_t bits_of(float x) noexcept {
  std::int32_t bits;
  memcpy(&bits, &x, sizeof bits);
  return bits;
}
template <class Lanes, class Bits>
RPTV_LANES Lanes from_bits(Bits bits) noexcept {
  if constexpr (sizeof(Lanes) == sizeof(float)) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
  } else {
    return reinterpret_cast<Lanes>(bits);
  }
}
template <class Lanes, class Bits>
RPTV_LANES Lanes float_of(Bits whole) noexcept {
  if constexpr (sizeof(Lanes) == sizeof(float))
    return static_cast<float>(whole);
  else
    return __builtin_convertvector(whole, Lanes);
}
template <class Bits, class Lanes>
RPTV_LANES Bits whole_of(Lanes x) noexcept {
  if constexpr (sizeof(Lanes) == sizeof(float))
    return x == x ? static_cast<std::int32_t>(x) : 0;
  else
    return __builtin_convertvector(x, Bits);
}
template <class Bits>
RPTV_LANES Bits shifted_by_23(Bits bits) noexcept {
  if constexpr (sizeof(Bits) == sizeof(std::int32_t))
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(bits) << 23);
  else
    return bits << 23;
}

}  // namespace rptv
