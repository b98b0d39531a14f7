// SPDX-License-Identifier: MIT
// The box that enough cameras of a rig see together.
#pragma once

#include "calibration/cameras/rig.hpp"
#include "reconstruct/multi_view/view_rays.hpp"

namespace rptv {

/// Of the points round the place that the cameras look at, the box of those in at least `min_views` images. Found on a
/// grid; set-up only. Throws Error(configuration) when the cameras look at no common place.
Volume seen_volume(const Rig& rig, std::size_t min_views);

}  // namespace rptv
