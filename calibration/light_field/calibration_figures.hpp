// SPDX-License-Identifier: MIT
// What a person looks at before trusting a calibration: the centres over the image, and the residuals as arrows.
#pragma once

#include "calibration/light_field/find_lenslets.hpp"
#include "core/colour_image.hpp"

namespace rptv {

/// The image with a cross where the lattice puts each sub-image: green where it was fitted, orange where it is
/// vignetted (area, eccentricity), red where it is dark or off the lattice. As figures 12 and 13 of the proposal.
ColourImage draw_centres(const GreyImage& image, const FoundLenslets& found);

/// Arrows from each expected to its measured centre: thin blue for fitted lenslets, orange for those left out; thick
/// black for means over blocks of 8 x 8 fitted ones. All are `enlargement` times too long.
ColourImage draw_residuals(const GreyImage& image, const FoundLenslets& found, double enlargement);

/// Enlargement that makes the median fitted residual a third of a pitch; a round number (1, 2 or 5 times a power of
/// 10).
double residual_enlargement(const FoundLenslets& found, double pitch_px);

}  // namespace rptv
