// SPDX-License-Identifier: MIT
// When a pixel is a local maximum of its eight neighbours.
#pragma once

#include <cstddef>

#include "reconstruct/host_device.hpp"

namespace rptv {

template <class Pixel>
RPTV_HOST_DEVICE Pixel larger_of(Pixel a, Pixel b) noexcept {
  return a < b ? b : a;
}

/// A maximum is above the four neighbours before it in raster order and not below the four after it, so that of equal
/// neighbours one counts. Of three rows, `pixels` points into the middle one; a row is `stride` pixels long.
template <class Pixel>
RPTV_HOST_DEVICE bool is_maximum(const Pixel* pixels, std::ptrdiff_t stride) noexcept {
  const Pixel *above = pixels - stride, *below = pixels + stride;
  const Pixel before = larger_of(larger_of(above[-1], above[0]), larger_of(above[1], pixels[-1]));
  const Pixel after = larger_of(larger_of(pixels[1], below[-1]), larger_of(below[0], below[1]));
  return pixels[0] > before && pixels[0] >= after;
}

}  // namespace rptv
