// SPDX-License-Identifier: MIT
// Between pixels and millimetres about the optical axis.
#pragma once

#include <array>

#include "calibration/light_field/light_field_calibration.hpp"

namespace rptv {

/// Pixel centres are integers; mm have their origin on the optical axis, x along columns, y along rows.
struct SensorFrame {
  std::array<double, 2> axis_px{};
  double pixel_mm = 1;

  explicit SensorFrame(const LightFieldCalibration& calibration)
      : axis_px(calibration.optical_axis_px()), pixel_mm(calibration.pixel_mm()) {}
  std::array<double, 2> to_px(const std::array<double, 2>& mm) const noexcept {
    return {axis_px[0] + mm[0] / pixel_mm, axis_px[1] + mm[1] / pixel_mm};
  }
  std::array<double, 2> to_mm(const std::array<double, 2>& px) const noexcept {
    return {(px[0] - axis_px[0]) * pixel_mm, (px[1] - axis_px[1]) * pixel_mm};
  }
};

}  // namespace rptv
