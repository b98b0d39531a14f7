// SPDX-License-Identifier: MIT
// An image and what is known of its dark pixels, as they lie on the device.
#pragma once

#include <cstdint>

namespace rptv {

/// Rows contiguous without padding; pixel centres are integers, x is the column and y the row.
struct CudaImage {
  const void* pixels;  ///< std::uint8_t or std::uint16_t
  std::uint32_t width_px, height_px, bytes_per_pixel;
};

/// DarkPixels: grey value without light, and the highest that is still dark. One value each, or one a pixel.
struct CudaDark {
  const float* mean;
  const std::uint16_t* limit;
  bool uniform;  ///< one value each
};

/// Local maxima above their limit, in raster order, of which the first `capacity` are written. There are
/// row_start[height_px] of them; those of row y are from row_start[y] to row_start[y + 1].
struct CudaMaxima {
  std::int32_t *x, *y;       ///< capacity each
  std::uint32_t* row_start;  ///< height_px + 1
  std::uint32_t capacity;
};

}  // namespace rptv
