// SPDX-License-Identifier: MIT
// Brown's polynomial forwards, and Newton's method back, kept within the fold.
#include "calibration/cameras/brown_distortion.hpp"

#include <algorithm>
#include <cmath>

namespace rptv {

namespace {
constexpr int kQuickSteps = 6, kMostSteps = 50;
constexpr double kFarthest = 1e3;  ///< focal lengths: 89.94 degrees off the axis

/// The smallest positive root in s = r² of d(r·radial)/dr = 1 + 3 k1 s + 5 k2 s² + 7 k3 s³, by its sign on a fine
/// geometric ladder and bisection; infinite when the sign never changes below kFarthest².
double fold_of(double k1, double k2, double k3) {
  const auto growth = [&](double s) { return 1 + s * (3 * k1 + s * (5 * k2 + s * 7 * k3)); };
  double low = 0;
  for (double high = 1e-6; high < kFarthest * kFarthest; low = high, high *= 1.01) {
    if (growth(high) > 0) continue;
    for (int step = 0; step < 60; ++step) {
      const double middle = 0.5 * (low + high);
      (growth(middle) > 0 ? low : high) = middle;
    }
    return std::sqrt(low);
  }
  return std::numeric_limits<double>::infinity();
}

double determinant_of(const Matrix2& m) noexcept { return m[0][0] * m[1][1] - m[0][1] * m[1][0]; }
}  // namespace

BrownDistortion::BrownDistortion(double k1, double k2, double k3, double p1, double p2)
    : k1_(k1), k2_(k2), k3_(k3), p1_(p1), p2_(p2), fold_radius_(fold_of(k1, k2, k3)) {
  none_ = k1 == 0 && k2 == 0 && k3 == 0 && p1 == 0 && p2 == 0;
}

Pixel BrownDistortion::apply(const Pixel& ideal) const noexcept {
  const auto [x, y] = ideal;
  const double r2 = x * x + y * y, scale = radial(r2);
  return {x * scale + 2 * p1_ * x * y + p2_ * (r2 + 2 * x * x), y * scale + p1_ * (r2 + 2 * y * y) + 2 * p2_ * x * y};
}

Matrix2 BrownDistortion::derivative(const Pixel& ideal) const noexcept {
  const auto [x, y] = ideal;
  const double r2 = x * x + y * y, scale = radial(r2);
  const double twice_slope = 2 * (k1_ + r2 * (2 * k2_ + r2 * 3 * k3_));  // 2·d(radial)/d(r²)
  const double mixed = x * y * twice_slope + 2 * p1_ * x + 2 * p2_ * y;
  return {{{scale + x * x * twice_slope + 2 * p1_ * y + 6 * p2_ * x, mixed},
           {mixed, scale + y * y * twice_slope + 6 * p1_ * y + 2 * p2_ * x}}};
}

std::optional<Pixel> BrownDistortion::distort(const Pixel& ideal) const noexcept {
  if (none_) return ideal;
  if (!within_fold(ideal)) return std::nullopt;
  if ((p1_ != 0 || p2_ != 0) && !(determinant_of(derivative(ideal)) > 0)) return std::nullopt;
  return apply(ideal);
}

/// Radius that the radial part alone takes to `seen_radius`; the fold's where that is beyond.
double BrownDistortion::ideal_radius(double seen_radius) const noexcept {
  double low = 0, high = fold_radius_;
  if (!std::isfinite(high))
    for (high = std::max(seen_radius, 1e-3); high < kFarthest && high * radial(high * high) < seen_radius;) high *= 2;
  double r = std::min(seen_radius, high);
  for (int step = 0; step < kMostSteps; ++step) {
    const double r2 = r * r, excess = r * radial(r2) - seen_radius;
    (excess > 0 ? high : low) = r;
    const double slope = 1 + r2 * (3 * k1_ + r2 * (5 * k2_ + r2 * 7 * k3_));
    double next = r - excess / slope;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    if (std::abs(next - r) <= 1e-15 * r) break;
    r = next;
  }
  return r;
}

/// One step of Newton's method towards `seen`; its squared length, or NaN where the image folds.
double BrownDistortion::approach(const Pixel& seen, Pixel& ideal) const noexcept {
  const Pixel there = apply(ideal);
  const Matrix2 m = derivative(ideal);
  const double d = determinant_of(m), x = seen[0] - there[0], y = seen[1] - there[1];
  if (!(d > 0)) return std::numeric_limits<double>::quiet_NaN();
  const double step_x = (m[1][1] * x - m[0][1] * y) / d, step_y = (m[0][0] * y - m[1][0] * x) / d;
  ideal[0] += step_x, ideal[1] += step_y;
  return step_x * step_x + step_y * step_y;
}

std::optional<Pixel> BrownDistortion::undistort(const Pixel& seen) const noexcept {
  if (none_) return seen;
  // The common case: a few steps from where the light lands. A step of 1e-8 leaves its square.
  Pixel ideal = seen;
  for (int step = 0; step < kQuickSteps; ++step) {
    const double length2 = approach(seen, ideal);
    if (length2 <= 1e-16) return within_fold(ideal) ? std::optional(ideal) : undistort_carefully(seen);
  }
  return undistort_carefully(seen);
}

/// From the radial part's own inverse, which bisection finds wherever there is one.
std::optional<Pixel> BrownDistortion::undistort_carefully(const Pixel& seen) const noexcept {
  const double radius = std::hypot(seen[0], seen[1]);
  if (!(radius < kFarthest)) return std::nullopt;
  const double scale = radius > 0 ? ideal_radius(radius) / radius : 1;
  Pixel ideal{scale * seen[0], scale * seen[1]};
  for (int step = 0; step < kMostSteps; ++step) {
    const double length2 = approach(seen, ideal);
    if (!(length2 == length2)) return std::nullopt;
    if (length2 <= 1e-30) break;
  }
  const auto back = distort(ideal);
  if (!back || !(std::hypot((*back)[0] - seen[0], (*back)[1] - seen[1]) < 1e-12 * (1 + radius))) return std::nullopt;
  return ideal;
}

}  // namespace rptv
