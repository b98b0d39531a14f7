// SPDX-License-Identifier: MIT
// Figures of a camera calibration as text, as JSON, as a table of residuals and as a picture.
#pragma once

#include <string>

#include "calibration/cameras/calibrate_cameras.hpp"
#include "core/colour_image.hpp"

namespace rptv {

/// For people: each camera's lens and residuals, pairs, worst images, what was dropped and why, expected errors.
std::string to_text(const CameraCalibration& calibration);
/// The same and all images, as one JSON object, without a line break.
std::string to_json(const CameraCalibration& calibration);
/// CSV: camera,view,point,column,row,error_column,error_row (px; seen less expected).
std::string residual_table(const CameraCalibration& calibration);

/// A panel for each camera, side by side: where points were seen, from blue (as good as the others) to red (five
/// standard errors); dark places are those that no target reached, where the distortion is extrapolated.
ColourImage draw_coverage(const CameraCalibration& calibration);

}  // namespace rptv
