// SPDX-License-Identifier: MIT
// Brown's lens distortion, its derivative, its inverse, and where it stops to have one.
#pragma once

#include <array>
#include <limits>
#include <optional>

namespace rptv {

/// Column, row: in pixels (centres are integers), or in focal lengths from a centre.
using Pixel = std::array<double, 2>;

/// d(column, row)/d(column, row).
using Matrix2 = std::array<std::array<double, 2>, 2>;

/// Radial (k) and decentring (p) factors, all lengths in focal lengths, as OpenCV writes them:
/// x' = x(1 + k1 r² + k2 r⁴ + k3 r⁶) + 2 p1 xy + p2 (r² + 2x²), y' = y(…) + p1 (r² + 2y²) + 2 p2 xy  (Brown 1966).
/// Immutable, any thread.
class BrownDistortion {
 public:
  BrownDistortion() = default;
  BrownDistortion(double k1, double k2, double k3, double p1, double p2);

  /// Where the lens puts what a pinhole would put at `ideal`. None where the image folds back on itself (beyond the
  /// radius at which the radial part stops to grow, or where the whole turns over): light from there would look like
  /// light from elsewhere.
  std::optional<Pixel> distort(const Pixel& ideal) const noexcept;
  /// Its derivative, where it has a value.
  Matrix2 derivative(const Pixel& ideal) const noexcept;
  /// The one place within the fold that distort() takes to `seen`, to rounding; none when there is none.
  std::optional<Pixel> undistort(const Pixel& seen) const noexcept;

 private:
  double radial(double r2) const noexcept { return 1 + r2 * (k1_ + r2 * (k2_ + r2 * k3_)); }
  Pixel apply(const Pixel& ideal) const noexcept;
  bool within_fold(const Pixel& ideal) const noexcept {
    return ideal[0] * ideal[0] + ideal[1] * ideal[1] < fold_radius_ * fold_radius_;
  }
  double approach(const Pixel& seen, Pixel& ideal) const noexcept;
  std::optional<Pixel> undistort_carefully(const Pixel& seen) const noexcept;
  double ideal_radius(double seen_radius) const noexcept;

  double k1_ = 0, k2_ = 0, k3_ = 0, p1_ = 0, p2_ = 0;
  double fold_radius_ = std::numeric_limits<double>::infinity();  ///< focal lengths; infinite: no fold
  bool none_ = true;
};

}  // namespace rptv
