// SPDX-License-Identifier: MIT
// Gauss-Newton over the ten numbers of a lens whose centre of distortion is held, and its roll: without that the
// quadratic terms of the decentring, moved, leave a shear.
#include "calibration/cameras/centred_distortion.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <vector>

namespace rptv {

namespace {

constexpr int kGridSteps = 16;
constexpr int kMostSteps = 20;
constexpr int kFree = 11;

/// A pixel, and where a pinhole would have it, in focal lengths from the optical axis.
struct Sight {
  Pixel pixel, ideal;
};

std::vector<Sight> sights_of(const CameraIntrinsics& lens) {
  const BrownDistortion distortion(lens.k1, lens.k2, lens.k3, lens.p1, lens.p2);
  std::vector<Sight> sights;
  for (int i = 0; i <= kGridSteps; ++i)
    for (int j = 0; j <= kGridSteps; ++j) {
      const Pixel pixel{(lens.width_px - 1) * i / double{kGridSteps}, (lens.height_px - 1) * j / double{kGridSteps}};
      const double y = (pixel[1] - lens.cy_px) / lens.fy_px;
      if (const auto ideal = distortion.undistort({(pixel[0] - lens.cx_px - lens.skew_px * y) / lens.fx_px, y}))
        sights.push_back({pixel, {(*ideal)[0] - lens.offset_x, (*ideal)[1] - lens.offset_y}});
    }
  return sights;
}

std::array<double*, kFree> free_of(CentredDistortion& result) {
  auto& lens = result.lens;
  return {&lens.fx_px, &lens.fy_px, &lens.skew_px, &lens.offset_x, &lens.offset_y, &result.roll_rad,
          &lens.k1,    &lens.k2,    &lens.k3,      &lens.p1,       &lens.p2};
}

/// How far the lens is off at every sight, px: column, row, column, …
Eigen::VectorXd misses(const CentredDistortion& result, const std::vector<Sight>& sights) {
  const CameraIntrinsics& lens = result.lens;
  const double cosine = std::cos(result.roll_rad), sine = std::sin(result.roll_rad);
  const BrownDistortion distortion(lens.k1, lens.k2, lens.k3, lens.p1, lens.p2);
  Eigen::VectorXd off(2 * static_cast<Eigen::Index>(sights.size()));
  Eigen::Index row = 0;
  for (const Sight& sight : sights) {
    const Pixel ideal{cosine * sight.ideal[0] - sine * sight.ideal[1] + lens.offset_x,
                      sine * sight.ideal[0] + cosine * sight.ideal[1] + lens.offset_y};
    const Pixel there = distortion.distort(ideal).value_or(ideal);
    off[row++] = lens.fx_px * there[0] + lens.skew_px * there[1] + lens.cx_px - sight.pixel[0];
    off[row++] = lens.fy_px * there[1] + lens.cy_px - sight.pixel[1];
  }
  return off;
}

double worst_of(const Eigen::VectorXd& off) {
  return off.size() == 0 ? 0 : off.reshaped(2, off.size() / 2).colwise().norm().maxCoeff();
}

}  // namespace

CentredDistortion centred_distortion(const CameraIntrinsics& lens) {
  const std::vector<Sight> sights = sights_of(lens);
  CentredDistortion best{lens};
  CameraIntrinsics& centred = best.lens;
  centred.cx_px = 0.5 * (lens.width_px - 1), centred.cy_px = 0.5 * (lens.height_px - 1);
  const double y = (lens.cy_px - centred.cy_px) / lens.fy_px;
  centred.offset_y += y, centred.offset_x += (lens.cx_px - centred.cx_px - lens.skew_px * y) / lens.fx_px;
  Eigen::VectorXd off = misses(best, sights);
  const double radius = std::hypot(centred.cx_px / lens.fx_px, centred.cy_px / lens.fy_px);
  const double r2 = radius * radius, px = 1 / lens.fx_px;
  // steps of the numerical derivative: each moves a corner by about a pixel
  const double steps[] = {1 / radius,
                          1 / radius,
                          1 / radius,
                          px,
                          px,
                          px / radius,
                          px / (r2 * radius),
                          px / (r2 * r2 * radius),
                          px / (r2 * r2 * r2 * radius),
                          px / r2,
                          px / r2};
  static_assert(std::size(steps) == kFree);
  for (int iteration = 0; iteration < kMostSteps && worst_of(off) > 1e-8; ++iteration) {
    Eigen::MatrixXd slopes(off.size(), kFree);
    for (int k = 0; k < kFree; ++k) {
      CentredDistortion more = best, less = best;
      const auto index = static_cast<std::size_t>(k);
      *free_of(more)[index] += 0.01 * steps[index], *free_of(less)[index] -= 0.01 * steps[index];
      slopes.col(k) = (misses(more, sights) - misses(less, sights)) / 0.02;
    }
    const Eigen::VectorXd change = slopes.colPivHouseholderQr().solve(-off);
    CentredDistortion next = best;
    for (std::size_t k = 0; k < kFree; ++k) *free_of(next)[k] += steps[k] * change[static_cast<Eigen::Index>(k)];
    const Eigen::VectorXd left = misses(next, sights);
    if (!(left.squaredNorm() < (1 - 1e-9) * off.squaredNorm())) break;
    best = next, off = left;
  }
  best.worst_px = worst_of(off);
  return best;
}

}  // namespace rptv
