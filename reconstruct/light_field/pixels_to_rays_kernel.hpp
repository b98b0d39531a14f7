// SPDX-License-Identifier: MIT
// The arithmetic of eq. (5): the ray of a pixel through a lenslet. Host and device.
#pragma once

#include <cstdint>

#include "reconstruct/host_device.hpp"
#include "reconstruct/light_field/ray.hpp"

namespace rptv {

/// Where pixels are behind the lenslets.
struct PixelOptics {
  float axis_x_px = 0, axis_y_px = 0;  ///< where the optical axis meets the sensor
  float pixel_mm = 1;
  float per_focal_length = 1;  ///< 1/f of the lenslets, 1/mm
};

/// The ray from pixel (column, row) through the lenslet centred at (centre_x, centre_y), mm.
RPTV_HOST_DEVICE inline Ray ray_of(const PixelOptics& optics, std::uint32_t column, std::uint32_t row, float centre_x,
                                   float centre_y) noexcept {
  const float x = (static_cast<float>(column) - optics.axis_x_px) * optics.pixel_mm;
  const float y = (static_cast<float>(row) - optics.axis_y_px) * optics.pixel_mm;
  return {centre_x, centre_y, (centre_x - x) * optics.per_focal_length, (centre_y - y) * optics.per_focal_length};
}

}  // namespace rptv
