// SPDX-License-Identifier: MIT
// What the fit of a Gaussian says about one spot.
#pragma once

#include <array>
#include <cmath>

#include "reconstruct/detection/lit_maxima.hpp"

namespace rptv {

struct FittedSpot {
  PixelIndex start;  ///< where the search for it began
  double x_px = 0, y_px = 0;
  float variance_px2 = 0;          ///< of x_px and of y_px, each
  float grey = 0, area_px = 0;     ///< as of Detection
  float peak = 0;                  ///< highest value of the Gaussian
  float bend = 0;                  ///< -1/2σ² of it, px⁻²; 0: a Gaussian does not describe it
  float misfit = 0;                ///< reduced χ²
  float nearest_px2 = 1e9F;        ///< squared distance of the nearest other one
  float others = 0;                ///< light of the others in its square, when it was fitted last
  bool crowded = false;            ///< others' light falls into its square
  bool modelled = false;           ///< its Gaussian is in the model of the image
  bool wide = false;               ///< too much for a pair of spots: none is looked for in it
  std::array<double, 2> shared{};  ///< how much of its place, along and across, it shares with crowding ones: 0 to 1

  PixelIndex middle() const noexcept {
    return {static_cast<std::int32_t>(std::lround(x_px)), static_cast<std::int32_t>(std::lround(y_px))};
  }
};

}  // namespace rptv
