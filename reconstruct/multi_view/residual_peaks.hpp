// SPDX-License-Identifier: MIT
// Where a residual image may hold particles that are not known yet: its local maxima, with sub-pixel places.
#pragma once

#include <span>

#include "reconstruct/detection/detections.hpp"
#include "reconstruct/multi_view/residual_view.hpp"

namespace rptv {

struct PeakOptions {
  float threshold = 20;        ///< grey values over what the known particles explain
  float threshold_sigmas = 6;  ///< and standard deviations of the pixel; not asked of saturated ones
};

/// Replaces what is in `out`. A place is where a Gaussian of standard deviation `sigma_px` (of the particle image,
/// without the pixel) through the maximum's neighbours has its top; grey is the light of one that is as high. What does
/// not fit is counted in out.overflow().
void find_peaks(const ResidualView& view, const PeakOptions& options, float sigma_px, Detections& out) noexcept;

/// Median standard deviation of the particle images, px, by the curvature of the logarithm at the maxima; what
/// `otherwise` says where there are fewer than ten. `scratch` has room for as many as are looked at.
float typical_sigma_px(const ResidualView& view, const PeakOptions& options, std::span<float> scratch,
                       float otherwise) noexcept;

}  // namespace rptv
