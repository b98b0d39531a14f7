// SPDX-License-Identifier: MIT
// How many sets of detections that are spread at random meet: what the list of matches needs room for.
#pragma once

#include <cstddef>

#include "calibration/cameras/rig.hpp"
#include "reconstruct/multi_view/view_rays.hpp"

namespace rptv {

/// How many sets of `min_views` = m detections lie within `tolerance_px` of where some point of the volume is seen,
/// when each view has `detections`, of particles of its own that fill the volume evenly: about that many for m = 2, and
/// about twice as many as there are for each view more. The pixels of the points of a volume dV are a 3-dimensional
/// surface of size √det(JᵀJ)·dV in the 2m dimensions of m views' pixels (J: their derivatives by the point, stacked),
/// and sets meet in a tube round it: here a ball of 2m - 3 dimensions with radius √m·tolerance. Sets of more views
/// replace those within them. Set-up only.
double matches_by_chance(const Rig& rig, const Volume& volume, std::size_t detections, std::size_t min_views,
                         double tolerance_px);

}  // namespace rptv
