// SPDX-License-Identifier: MIT
// The 4×4 systems of shaking, scaled to a unit diagonal.
#include "reconstruct/light_field/shake_step.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace rptv {

namespace {

constexpr double kMostAsideMm = 0.03, kMostDepthMm = 1.5, kMostDepthShare = 0.2;

struct Scaled {
  Eigen::Matrix4d normal;
  Eigen::Vector4d scale;  // 1/sqrt(diagonal)
  bool sound;
};

Scaled scaled(const ShakeSums& sums) noexcept {
  Scaled s;
  for (int row = 0, k = 0; row < 4; ++row)
    for (int column = row; column < 4; ++column, ++k)
      s.normal(row, column) = s.normal(column, row) = sums.normal[static_cast<std::size_t>(k)];
  s.sound = (s.normal.diagonal().array() > 0).all() && s.normal.allFinite();
  if (!s.sound) return s;
  s.scale = s.normal.diagonal().array().rsqrt();
  s.normal = s.scale.asDiagonal() * s.normal * s.scale.asDiagonal();
  return s;
}

}  // namespace

double take_step(const ShakeSums& sums, double damping, FittedParticle& particle) noexcept {
  Scaled s = scaled(sums);
  if (!s.sound) return 0;
  s.normal.diagonal().array() += damping + 1e-9;
  const Eigen::Vector4d pull(sums.pull[0], sums.pull[1], sums.pull[2], sums.pull[3]);
  Eigen::Vector4d step = s.scale.asDiagonal() * s.normal.ldlt().solve(s.scale.asDiagonal() * pull);
  if (!step.allFinite()) return 0;
  const double most_depth = kMostDepthMm + kMostDepthShare * std::abs(particle.at.z);
  const double over = std::max(
      {1.0, std::abs(step[0]) / kMostAsideMm, std::abs(step[1]) / kMostAsideMm, std::abs(step[2]) / most_depth});
  step /= over;
  particle.at = {particle.at.x + step[0], particle.at.y + step[1], particle.at.z + step[2]};
  particle.light += step[3];
  return step.dot(pull);
}

FitCovariance covariance_of(const ShakeSums& sums, double scale, double border_mm, double slope_rms,
                            const ImagePoint& chief) noexcept {
  Scaled s = scaled(sums);
  if (!s.sound) return {1, 0, 0, 1, 0, 1e4};
  s.normal.diagonal().array() += 1e-9;
  const Eigen::Matrix4d c =
      scale * (s.scale.asDiagonal() * s.normal.ldlt().solve(Eigen::Matrix4d(s.scale.asDiagonal())));
  const double aside = border_mm * border_mm, depth = aside / (slope_rms * slope_rms);
  // A wrong depth moves the point along its chief ray.
  return {c(0, 0) + aside + depth * chief.x * chief.x, c(0, 1) + depth * chief.x * chief.y, c(0, 2) + depth * chief.x,
          c(1, 1) + aside + depth * chief.y * chief.y, c(1, 2) + depth * chief.y,           c(2, 2) + depth};
}

}  // namespace rptv
