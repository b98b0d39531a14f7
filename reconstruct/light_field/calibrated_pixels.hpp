// SPDX-License-Identifier: MIT
// What a calibration's arrays say about each pixel: dark level, noise, and how much of the light gets there.
#pragma once

#include <vector>

#include "calibration/light_field/lenslet_lattice.hpp"
#include "reconstruct/dark_pixels.hpp"

namespace rptv {

/// Row by row; empty where the calibration has no such array. A plain value.
struct CalibratedPixels {
  std::vector<float> level;  ///< grey value without light
  /// Its rms, grey values: the pixel's own, but no less than that of the 17x17 pixels round it, since from few dark
  /// images a pixel's own may be far too low.
  std::vector<float> noise;
  /// Brightness of the pixel's sub-image in even light over that of those on the axis, between `least_share` and 1; 1
  /// where it is unknown.
  std::vector<float> share;

  KnownPixels view() const noexcept { return {level, noise, share}; }
};

/// Set-up only; any thread.
CalibratedPixels calibrated_pixels(const LightFieldCalibration& calibration, const LensletLattice& lattice,
                                   double least_share);

}  // namespace rptv
