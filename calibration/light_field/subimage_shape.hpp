// SPDX-License-Identifier: MIT
// Light, area and roundness of sub-images, each from its own cell and its neighbours' (vignetting is smooth).
#pragma once

#include <array>
#include <vector>

#include "calibration/grey_image.hpp"

namespace rptv {

/// Sums over a round window about the expected centre of grey values above dark; px.
struct SubimageMoments {
  double light = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  double cells = 0;  ///< how many cells the sums are of

  void add(const SubimageMoments& other) noexcept;
  /// From the expected centre; 0 without light.
  std::array<double, 2> centroid_px() const noexcept {
    return light > 0 ? std::array<double, 2>{x / light, y / light} : std::array<double, 2>{};
  }
  /// Square root of the determinant of the second moments about the centroid: area up to a factor. 0 without light.
  double area_px2() const noexcept;
  /// Short over long axis; 1 is round.
  double axis_ratio() const noexcept;
};

SubimageMoments moments_of(const GreyImage& image, std::array<double, 2> at_px, double radius_px, double dark);

/// Sums of the moments over squares of (2·reach + 1)² lattice points; [row·columns + column], NaN-free.
std::vector<SubimageMoments> sum_over_neighbours(const std::vector<SubimageMoments>& moments, int columns, int reach);

}  // namespace rptv
