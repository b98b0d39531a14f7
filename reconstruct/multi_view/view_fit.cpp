// SPDX-License-Identifier: MIT
// Weighted normal equations of the reprojection error, two steps, and their inverse.
#include "reconstruct/multi_view/view_fit.hpp"

#include <cmath>

#include "calibration/space_algebra.hpp"

namespace rptv {

namespace {

struct NormalEquations {
  Matrix3 matrix{};
  Point3 right{};

  void add(const Point3& gradient, double miss, double weight) noexcept {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) matrix[i][k] += weight * gradient[i] * gradient[k];
      right[i] -= weight * gradient[i] * miss;
    }
  }
};

// A point's offset from the ray, in the plane at its depth, is (axes[0] - dx·axes[2])·at - x and the same for y; the
// footprint at that depth turns mm into px.
void add_view(NormalEquations& sum, const SeenRay& ray, const Matrix3& axes, const Point3& at, double weight) noexcept {
  const auto miss = miss_px(ray, axes, at);
  const double t = dot(axes[2], at);
  const double a = ray.foot[0] + t * ray.foot_dt[0], b = ray.foot[1] + t * ray.foot_dt[1];
  const double c = ray.foot[2] + t * ray.foot_dt[2], d = ray.foot[3] + t * ray.foot_dt[3];
  const double per = 1 / (a * d - b * c);
  const Point3 off_x = axes[0] - ray.dx * axes[2], off_y = axes[1] - ray.dy * axes[2];
  sum.add(per * (d * off_x - b * off_y), miss[0], weight);
  sum.add(per * (a * off_y - c * off_x), miss[1], weight);
}

double square_distance(const SeenRay& ray, const Matrix3& axes, const Point3& at) noexcept {
  const double t = dot(axes[2], at);
  const double x = dot(axes[0], at) - ray.x - t * ray.dx, y = dot(axes[1], at) - ray.y - t * ray.dy;
  const double along = x * ray.dx + y * ray.dy;
  return x * x + y * y - along * along / (1 + ray.dx * ray.dx + ray.dy * ray.dy);
}

}  // namespace

Particle fit_views(std::span<const SeenView> views, std::span<const Detections> seen, const ViewMatch& match,
                   double calibration_px) noexcept {
  constexpr int kSteps = 2;  // the first one is within rounding unless a view is hardly weighted
  Point3 at = match.at_mm;
  Matrix3 covariance{};
  for (int step = 0; step < kSteps; ++step) {
    NormalEquations sum;
    for (std::size_t v = 0; v < views.size(); ++v) {
      const std::uint32_t i = match.tuple.detection[v];
      if (i == kUnseen) continue;
      const double sigma = seen[v].sigma_px[i];
      const double variance = std::max(sigma * sigma + calibration_px * calibration_px, 1e-6);
      add_view(sum, views[v].ray(i), views[v].rays().axes(), at, 1 / variance);
    }
    covariance = inverse(sum.matrix);
    at = at + covariance * sum.right;
  }
  double square = 0;
  for (std::size_t v = 0; v < views.size(); ++v)
    if (match.tuple.detection[v] != kUnseen)
      square += square_distance(views[v].ray(match.tuple.detection[v]), views[v].rays().axes(), at);
  Particle particle;
  particle.x_mm = at[0], particle.y_mm = at[1], particle.z_mm = at[2];
  particle.residual_mm = std::sqrt(std::max(square, 0.0) / match.tuple.views);
  particle.support = match.tuple.views;
  particle.covariance_mm2 = {covariance[0][0], covariance[0][1], covariance[0][2],
                             covariance[1][1], covariance[1][2], covariance[2][2]};
  return particle;
}

}  // namespace rptv
