// SPDX-License-Identifier: MIT
// What a lenslet calibration says of itself, for people and for scripts.
#pragma once

#include <string>

#include "calibration/light_field/calibrate_lenslets.hpp"

namespace rptv {

/// Lines of text, the last one ended: counts, residuals, pitch against the data sheet, exit pupil, what is unsure.
std::string to_text(const LensletCalibrationResult& result);
/// One JSON object with the same figures.
std::string to_json(const LensletCalibrationResult& result);

/// Median and 95th percentile of the distances between fitted sub-images and lattice, px.
struct ResidualFigures {
  double median_px = 0, p95_px = 0;
};
ResidualFigures residual_figures(const FoundLenslets& found);

}  // namespace rptv
