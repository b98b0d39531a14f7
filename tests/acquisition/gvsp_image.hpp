// SPDX-License-Identifier: MIT
// Images whose every byte tells whether it is the right one.
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

namespace rptv {

inline constexpr std::uint64_t kImageStep = 0x9E3779B97F4A7C15ULL;

/// Image `sequence`: the number itself in the first 8 bytes, then words made from it.
inline void fill_image(std::uint8_t* image, std::size_t bytes, std::uint64_t sequence) {
  for (std::size_t i = 0; i + 8 <= bytes; i += 8) {
    const std::uint64_t word = i == 0 ? sequence : sequence * kImageStep + i;
    std::memcpy(image + i, &word, 8);
  }
}

/// The number, or 0 when any byte is wrong (numbers begin at 1).
inline std::uint64_t sequence_of(const std::uint8_t* image, std::size_t bytes) {
  std::uint64_t sequence = 0;
  std::memcpy(&sequence, image, 8);
  std::vector<std::uint8_t> expected(bytes);
  fill_image(expected.data(), bytes, sequence);
  return std::memcmp(expected.data(), image, bytes) == 0 ? sequence : 0;
}

}  // namespace rptv
