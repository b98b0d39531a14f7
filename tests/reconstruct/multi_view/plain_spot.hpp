// SPDX-License-Identifier: MIT
// The oracle of the particle image: a Gaussian integrated over each pixel of the whole image, in double.
#pragma once

#include <cmath>
#include <vector>

#include "reconstruct/multi_view/view_spot.hpp"

namespace rptv::testing {

inline double plain_share(double pixel, double centre_px, double sigma_px) {
  const double per = 1 / (std::sqrt(2.0) * sigma_px);
  return 0.5 * (std::erf((pixel + 0.5 - centre_px) * per) - std::erf((pixel - 0.5 - centre_px) * per));
}

inline double plain_slope(double pixel, double centre_px, double sigma_px) {
  const auto bell = [&](double at) {
    const double x = (at - centre_px) / sigma_px;
    return std::exp(-0.5 * x * x) / (std::sqrt(2 * M_PI) * sigma_px);
  };
  return bell(pixel - 0.5) - bell(pixel + 0.5);
}

/// Adds the spots to a row-major image.
inline void add_plain_spots(const std::vector<ViewSpot>& spots, int width_px, int height_px,
                            std::vector<double>& image) {
  for (const ViewSpot& spot : spots)
    for (int y = 0; y < height_px; ++y)
      for (int x = 0; x < width_px; ++x)
        image[static_cast<std::size_t>(y * width_px + x)] +=
            static_cast<double>(spot.grey) *
            plain_share(x, static_cast<double>(spot.u_px), static_cast<double>(spot.sigma_px)) *
            plain_share(y, static_cast<double>(spot.v_px), static_cast<double>(spot.sigma_px));
}

}  // namespace rptv::testing
