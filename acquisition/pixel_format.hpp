// SPDX-License-Identifier: MIT
// The GenICam pixel formats (PFNC) that become images here, and how their bits lie in a payload.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "acquisition/unpack.hpp"

namespace rptv {

/// One monochrome format; values of 10 to 16 bits become little-endian words.
struct PixelFormat {
  using Unpack = void (*)(const std::byte*, std::uint16_t*, std::size_t, InstructionSet) noexcept;

  std::string_view name;           ///< as in the camera's PixelFormat feature
  std::uint32_t significant_bits;  ///< grey values lie in 0 … 2^bits − 1
  std::uint32_t payload_bits;      ///< bits per pixel on the wire
  std::uint32_t bytes_per_pixel;   ///< in the image
  Unpack unpack = nullptr;         ///< null: the payload is the image

  constexpr std::size_t payload_bytes(std::size_t pixels) const noexcept { return (pixels * payload_bits + 7) / 8; }
};

inline constexpr std::array<PixelFormat, 8> kPixelFormats{{{"Mono8", 8, 8, 1},
                                                           {"Mono10", 10, 16, 2},
                                                           {"Mono12", 12, 16, 2},
                                                           {"Mono16", 16, 16, 2},
                                                           {"Mono10p", 10, 10, 2, &unpack_mono10p},
                                                           {"Mono12p", 12, 12, 2, &unpack_mono12p},
                                                           {"Mono10Packed", 10, 12, 2, &unpack_mono10_packed},
                                                           {"Mono12Packed", 12, 12, 2, &unpack_mono12_packed}}};

/// nullptr for a format that is not taken.
constexpr const PixelFormat* find_pixel_format(std::string_view name) noexcept {
  for (const PixelFormat& format : kPixelFormats)
    if (format.name == name) return &format;
  return nullptr;
}

}  // namespace rptv
