// SPDX-License-Identifier: MIT
// Cat's eyes: the round rims of a lens that cut its exit pupil off the axis, from how sub-images shrink and move.
#pragma once

#include <vector>

#include "calibration/light_field/find_lenslets.hpp"

namespace rptv {

/// Seen from a point of the array, a rim before or behind the stop is a disc that wanders across the exit pupil:
/// light through the pupil's point p (mm, x and y) reaches the array's point a when |p + shift·a| < radius.
struct PupilRim {
  double shift = 0;
  double radius_mm = 0;
};

/// Fits two rims, one on either side of the stop, to the light and the centroids of the sub-images of a white image
/// over their distance from the axis (least squares). Returns those that cut the field: none for a lens without
/// vignetting, with its exit pupil at infinity, whose sub-images overlap, or that rims do not explain. Set-up only.
std::vector<PupilRim> fit_pupil_rims(const FoundLenslets& found, const LightFieldCalibration& calibration);

}  // namespace rptv
