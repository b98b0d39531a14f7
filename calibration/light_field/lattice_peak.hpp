// SPDX-License-Identifier: MIT
// Pitch, rotation and origin of a lattice in an image, from the peaks of its spectrum: where the fit of a lattice
// begins.
#pragma once

#include <array>
#include <string>

#include "calibration/grey_image.hpp"

namespace rptv {

/// What the spectrum of the middle of an image says. Periods are of neighbours (hexagonal: not of the rows).
struct LatticePeak {
  double pitch_px = 0;
  double rotation_rad = 0;            ///< within ±π/4 (square) or ±π/6 (hexagonal)
  std::array<double, 2> origin_px{};  ///< brightest place of the period next to the middle of the image; column, row
  double significance = 0;            ///< weakest of the lattice's peaks over the median of the spectrum round it
  double subharmonic = 0;             ///< strongest half-frequency peak over the lattice's: near 1, the pitch is larger
};

/// Strongest lattice with a pitch from `shortest_px` to `longest_px`. `shape`: "square" or "hexagonal". Allocates 16
/// MB; any thread.
LatticePeak find_lattice_peak(const GreyImage& image, const std::string& shape, double shortest_px, double longest_px);

/// Least significance that noise does not reach.
inline constexpr double kSignificantPeak = 8;

}  // namespace rptv
