// SPDX-License-Identifier: MIT
// The first guess of the apparent lattice, from the spectrum, or the reason why the image has none.
#pragma once

#include "calibration/light_field/find_lenslets.hpp"

namespace rptv {

struct LatticeStart {
  LatticeParameters apparent;
  double significance = 0;
};

/// Throws Error(bad_data): empty, no lattice, another pitch than the data sheet's, moiré. `overlapping` puts the origin
/// on the darkest place of the period instead of the brightest.
LatticeStart find_lattice_start(const GreyImage& image, const LightFieldCalibration& start, const FindOptions& options);

/// The lattice with its origin moved by half a period in both directions.
LatticeParameters moved_by_half(const LatticeParameters& lattice);

}  // namespace rptv
