// SPDX-License-Identifier: MIT
// The mean sub-image, finer than the pixels, and where it fits best in each lenslet's cell.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "calibration/grey_image.hpp"

namespace rptv {

/// How the template lies in one cell: shift from where it was expected, grey values scaled and raised.
struct TemplateMatch {
  double dx_px = 0, dy_px = 0;
  double amplitude = 0;   ///< 1 where the cell is as bright as the template's mean
  double background = 0;  ///< grey values
  bool found = false;     ///< false: no light, or the match ran away
};

struct LocalPlane;

/// Mean of a periodic image round the lattice points given, on a grid of a third of a pixel, made symmetric under half
/// a turn: its origin is then the centre of symmetry, whatever the sub-images' form. Made once, read by any thread.
class SubimageTemplate {
 public:
  /// `centres_px`: column, row of each expected centre; all windows of radius `window_px` must lie in the image.
  SubimageTemplate(const GreyImage& image, std::span<const std::array<double, 2>> centres_px, double window_px);

  /// Least squares over the window, Gauss-Newton; `at_px` is where the centre is expected.
  TemplateMatch match(const GreyImage& image, std::array<double, 2> at_px) const;

  double level(double dx_px, double dy_px) const noexcept { return sample(dx_px, dy_px).value; }
  double lowest() const noexcept { return lowest_; }
  double highest() const noexcept { return highest_; }
  /// Diameter of a disc with the area that is above half of the range, px.
  double half_height_diameter_px() const noexcept;

 private:
  static constexpr int kFiner = 3;
  struct Sample {
    double value, slope_x, slope_y;  ///< per px
  };
  Sample sample(double dx_px, double dy_px) const noexcept;
  double& cell(int i, int j) noexcept { return grid_[static_cast<std::size_t>(j * side_ + i)]; }
  double cell(int i, int j) const noexcept { return grid_[static_cast<std::size_t>(j * side_ + i)]; }
  void spread(std::vector<LocalPlane>& nodes, double x, double y, double value) const;

  double window_px_;
  int half_, side_;
  double lowest_ = 0, highest_ = 0;
  std::vector<double> grid_;
};

}  // namespace rptv
