// SPDX-License-Identifier: MIT
// The vector loops behind unpack.hpp. Private to it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace rptv {

/// How 8 pixels lie in their bytes, as byte shuffles of 8 words (0x80 is a zero) and factors that shift each word.
struct StreamLayout {
  unsigned bits;   ///< per pixel
  unsigned bytes;  ///< that 8 pixels take
  std::array<std::uint8_t, 16> pair;
  std::array<std::uint16_t, 8> factor;  ///< brings the pixel to the top of its word
};

struct SplitLayout {
  unsigned bits;
  unsigned bytes;
  std::array<std::uint8_t, 16> high;
  std::array<std::uint8_t, 16> low;
  std::array<std::uint16_t, 8> factor;  ///< brings the pixel's low bits to bit 8
};

/// Both unpack a multiple of 16 pixels from the front, as many as they can without reading past `in_bytes`, and say how
/// many. Call only where AVX2 is there.
std::size_t unpack_stream_avx2(const StreamLayout& layout, const std::byte* in, std::size_t in_bytes,
                               std::uint16_t* out, std::size_t pixels) noexcept;
std::size_t unpack_split_avx2(const SplitLayout& layout, const std::byte* in, std::size_t in_bytes, std::uint16_t* out,
                              std::size_t pixels) noexcept;

}  // namespace rptv
