// SPDX-License-Identifier: MIT
// All lenses, camera poses and target poses at once, so that points fall where they were seen.
#pragma once

#include <optional>
#include <vector>

#include "calibration/cameras/board_views.hpp"
#include "calibration/cameras/bundle.hpp"
#include "calibration/cameras/bundle_covariance.hpp"

namespace rptv {

/// Two targets whose origins are at a known distance.
struct Rod {
  std::size_t first = 0, second = 0;  ///< views
  double length_mm = 0;
};

struct BundleOptions {
  bool fit_k3 = false;
  bool fit_lenses = true;
  bool fit_stack = false;  ///< direction and position of Bundle::stack (not the interfaces' distances from each other)
  bool single_points = false;             ///< targets are single points: how they are turned is held
  std::vector<Rod> rods;                  ///< known to a ten-thousandth, beside pixels of 0.1 px
  std::optional<std::size_t> frame_view;  ///< the target's pose in this view is in the covariance, as the rig's frame
  double length_factor = 3;               ///< residuals beyond this many standard errors count linearly (Huber 1964)
};

/// Where a point was seen, less where it should be.
struct PointResidual {
  std::size_t image = 0;  ///< place in BoardSet::images
  SeenPoint seen;
  Pixel error_px{};
};

struct BundleResult {
  Bundle bundle;
  std::vector<PointResidual> residuals;
  double rms_px = 0;         ///< root of the mean squared distance, all points
  double sigma_px = 0;       ///< standard error of a coordinate, robust (median), with the degrees of freedom taken off
  std::size_t outliers = 0;  ///< points farther away than 5 sigma
  /// Standard errors of parameters_of(lens) and parameters_of(camera pose), by the curvature at the end; zeros where
  /// held. Empty when the curvature is singular.
  std::vector<std::vector<double>> lens_sigma, camera_sigma;
  BundleCovariance covariance;  ///< what they are the diagonal of
  int iterations = 0;
};

/// Levenberg-Marquardt over reprojection errors with a robust loss (Ceres), exact derivatives; first with a wide loss,
/// then with one as wide as the errors found. Throws Error(bad_data) when it does not converge. Set-up only.
BundleResult adjust_bundle(const BoardSet& set, const Bundle& start, const BundleOptions& options);

}  // namespace rptv
