// SPDX-License-Identifier: MIT
// Places a corner where two edges cross by fitting the image of them, all grey values at once.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "calibration/cameras/board_views.hpp"
#include "calibration/grey_image.hpp"

namespace rptv {

/// What a corner looks like: two straight edges through `centre`, blurred, over a ground that may slope.
/// grey = level + slope·(p - centre) + contrast·erf(d1/√2σ)·erf(d2/√2σ), d: distances from the edges.
struct Saddle {
  Pixel centre{};
  double angle_1 = 0, angle_2 = 0;  ///< of the edges, rad from the column axis
  double blur_px = 1;               ///< σ
  double level = 0, contrast = 0;
};

struct SaddleFit {
  Saddle saddle;
  double centre_sigma_px = 0;  ///< standard error of a coordinate of the centre, by the residuals
};

/// Fits `start` (centre within two pixels, angles within 0.3 rad) to the pixels within `radius_px` that `hidden`
/// (row-major, like the image) has at zero. None when it runs away, the edges nearly coincide, or the noise hides them.
/// Set-up only.
std::optional<SaddleFit> fit_saddle(const GreyImage& image, const std::vector<std::uint8_t>& hidden,
                                    const Saddle& start, double radius_px);

}  // namespace rptv
