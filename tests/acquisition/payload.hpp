// SPDX-License-Identifier: MIT
// Packs pixels again as a camera sends them, so that every byte can be compared.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "acquisition/pixel_format.hpp"
#include "core/frame.hpp"

namespace rptv {

/// The payload that makes this image; `format` as in the camera's PixelFormat.
inline std::vector<std::uint8_t> payload_of(const Frame& frame, const std::string& format) {
  const std::uint8_t* bytes = frame.view().as_u8();
  if (find_pixel_format(format)->unpack == nullptr) return {bytes, bytes + frame.shape.bytes()};
  const std::uint16_t* pixels = frame.view().as_u16();
  const std::size_t count = frame.shape.bytes() / 2;
  std::vector<std::uint8_t> sent;
  if (format == "Mono12Packed") {
    for (std::size_t i = 0; i < count; i += 2)
      for (const int byte : {pixels[i] >> 4, (pixels[i] & 15) | (pixels[i + 1] & 15) << 4, pixels[i + 1] >> 4})
        sent.push_back(static_cast<std::uint8_t>(byte));
    return sent;
  }
  std::uint32_t bits = 0, held = 0;  // a stream, lowest bit first
  for (std::size_t i = 0; i < count; ++i) {
    bits |= std::uint32_t{pixels[i]} << held;
    for (held += find_pixel_format(format)->payload_bits; held >= 8; held -= 8, bits >>= 8)
      sent.push_back(static_cast<std::uint8_t>(bits));
  }
  return sent;
}

}  // namespace rptv
