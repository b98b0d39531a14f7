// SPDX-License-Identifier: MIT
// The lattice through measured spots: offset, pitch, rotation and, when it is seen, a cubic distortion; robust.
#pragma once

#include <cstddef>
#include <span>

#include "calibration/light_field/lenslet_geometry.hpp"

namespace rptv {

/// A spot measured at lattice point (u, v), mm.
struct LatticeSpot {
  int u = 0, v = 0;
  double x_mm = 0, y_mm = 0;
};

struct LatticeFit {
  LatticeParameters lattice;
  double scatter_mm = 0;      ///< robust standard deviation of the residuals, per axis
  double pitch_sigma_mm = 0;  ///< standard deviation of the pitch
  double cost = 0;            ///< sum of the loss over all spots, in squared scatters (Tukey)
  std::size_t used = 0;       ///< spots with a weight
  std::size_t parameters = 0;
};

/// Iteratively reweighted least squares (Tukey's biweight) from `start`, whose shape and radius are kept. Without
/// distortion that of `start` is dropped. `scatter_mm` above 0 fixes the scale of the loss, so that costs compare.
/// Needs 3 spots (20 with distortion) not on a line; returns `used` = 0 when they do not fix the lattice.
LatticeFit fit_lattice(std::span<const LatticeSpot> spots, const LatticeParameters& start, bool with_distortion,
                       double scatter_mm = 0);

/// With distortion when that explains more than chance (χ² falls by over 6 per further parameter) and moves a lenslet
/// by over a fifth of the scatter; else without. `may_bend` false: always without.
LatticeFit fit_lattice_as_seen(std::span<const LatticeSpot> spots, const LatticeParameters& start, bool may_bend);

}  // namespace rptv
