// SPDX-License-Identifier: MIT
// Square and hexagonal lattices through one pair of basis vectors, and a cubic distortion.
#include "calibration/light_field/lenslet_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rptv {

LensletGeometry::LensletGeometry(const LatticeParameters& parameters)
    : p_(parameters), cosine_between_(parameters.shape == "hexagonal" ? 0.5 : 0.0) {
  const double turn_b = p_.rotation_rad + (p_.shape == "hexagonal" ? std::numbers::pi / 3 : std::numbers::pi / 2);
  a_ = {p_.pitch_mm * std::cos(p_.rotation_rad), p_.pitch_mm * std::sin(p_.rotation_rad)};
  b_ = {p_.pitch_mm * std::cos(turn_b), p_.pitch_mm * std::sin(turn_b)};
  const double area = a_[0] * b_[1] - a_[1] * b_[0];
  const auto set = [](double c) { return c != 0; };
  const bool distorted = std::any_of(p_.distortion_x_mm.begin(), p_.distortion_x_mm.end(), set) ||
                         std::any_of(p_.distortion_y_mm.begin(), p_.distortion_y_mm.end(), set);
  inverse_ = {p_.offset_mm,
              {b_[1] / area, -b_[0] / area},
              {-a_[1] / area, a_[0] / area},
              p_.radius_mm,
              p_.distortion_x_mm,
              p_.distortion_y_mm,
              distorted};
}

std::array<double, 2> LensletGeometry::undistorted_mm(double u, double v) const noexcept {
  return {p_.offset_mm[0] + a_[0] * u + b_[0] * v, p_.offset_mm[1] + a_[1] * u + b_[1] * v};
}

std::array<double, 2> LensletGeometry::position_mm(double u, double v) const noexcept {
  const auto at = undistorted_mm(u, v);
  if (!inverse_.distorted) return at;
  const auto d = inverse_.distortion_mm(at[0], at[1]);
  return {at[0] + d[0], at[1] + d[1]};
}

std::array<double, 2> LensletGeometry::nearest_of(double x_mm, double y_mm) const noexcept {
  const auto [u, v] = lattice_of(x_mm, y_mm);
  std::array<double, 2> nearest{};
  double best = 1e300;
  for (const double at_u : {std::floor(u), std::floor(u) + 1})
    for (const double at_v : {std::floor(v), std::floor(v) + 1}) {
      const double distance = distance2(at_u - u, at_v - v);
      if (distance < best) best = distance, nearest = {at_u, at_v};
    }
  return nearest;
}

std::array<double, 2> LensletGeometry::reach(double reach_mm) const noexcept {
  return {reach_mm * (std::abs(inverse_.per_mm_u[0]) + std::abs(inverse_.per_mm_u[1])),
          reach_mm * (std::abs(inverse_.per_mm_v[0]) + std::abs(inverse_.per_mm_v[1]))};
}

double LensletGeometry::largest_distortion_mm() const noexcept {
  double largest = 0;
  for (int ring = 1; ring <= 4; ++ring)
    for (int k = 0; k < 24; ++k) {
      const double angle = k * std::numbers::pi / 12, radius = p_.radius_mm * ring / 4;
      const auto d = inverse_.distortion_mm(radius * std::cos(angle), radius * std::sin(angle));
      largest = std::max(largest, std::hypot(d[0], d[1]));
    }
  return largest;
}

}  // namespace rptv
