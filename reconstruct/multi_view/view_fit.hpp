// SPDX-License-Identifier: MIT
// The point that explains its views' detections best, with covariance: Gauss-Newton on the reprojection error.
#pragma once

#include <span>

#include "core/particles.hpp"
#include "reconstruct/detection/detections.hpp"
#include "reconstruct/multi_view/seen_view.hpp"
#include "reconstruct/multi_view/view_match.hpp"

namespace rptv {

/// Starts at match.at_mm. Every detection's coordinates are taken to be wrong by its sigma_px and, independently, by
/// `calibration_px` (rms per axis); the covariance is what that makes of the point. The derivative is the rays', so
/// that refraction and distortion are in it. The particle's position is relative to the volume's centre, its residual
/// the rms distance of the rays, its support the number of views. Any thread; allocates nothing.
Particle fit_views(std::span<const SeenView> views, std::span<const Detections> seen, const ViewMatch& match,
                   double calibration_px) noexcept;

}  // namespace rptv
