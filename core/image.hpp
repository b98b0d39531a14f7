// SPDX-License-Identifier: MIT
// What an image is: shape, grey depth, and a view of pixels that somebody else owns.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rptv {

/// Shape of a single-channel image. Rows grow downwards; the centre of pixel (column i, row j) is at (i, j).
struct ImageShape {
  std::uint32_t width_px = 0;
  std::uint32_t height_px = 0;
  std::uint32_t bytes_per_pixel = 1;  ///< 1: uint8, 2: uint16 in host byte order

  std::size_t row_bytes() const noexcept { return std::size_t{width_px} * bytes_per_pixel; }
  std::size_t bytes() const noexcept { return row_bytes() * height_px; }
  std::size_t pixels() const noexcept { return std::size_t{width_px} * height_px; }
  bool operator==(const ImageShape&) const = default;
  /// As many columns and rows, whatever the pixels.
  bool has_size_of(const ImageShape& other) const noexcept {
    return width_px == other.width_px && height_px == other.height_px;
  }
};

/// Read-only pixels, rows contiguous without padding. Valid as long as the lease or buffer behind it.
struct ImageView {
  const std::byte* data = nullptr;
  ImageShape shape;

  const std::uint8_t* as_u8() const noexcept { return reinterpret_cast<const std::uint8_t*>(data); }
  const std::uint16_t* as_u16() const noexcept { return reinterpret_cast<const std::uint16_t*>(data); }
};

}  // namespace rptv
