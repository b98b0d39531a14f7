// SPDX-License-Identifier: MIT
// Square and hexagonal lattices through one pair of basis vectors, and a cubic distortion.
#include "calibration/light_field/lenslet_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rptv {

std::array<double, kDistortionTerms> distortion_terms(double x, double y) noexcept {
  return {x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y};
}

LensletGeometry::LensletGeometry(const LatticeParameters& parameters)
    : p_(parameters), cosine_between_(parameters.shape == "hexagonal" ? 0.5 : 0.0) {
  const double turn_b = p_.rotation_rad + (p_.shape == "hexagonal" ? std::numbers::pi / 3 : std::numbers::pi / 2);
  a_ = {p_.pitch_mm * std::cos(p_.rotation_rad), p_.pitch_mm * std::sin(p_.rotation_rad)};
  b_ = {p_.pitch_mm * std::cos(turn_b), p_.pitch_mm * std::sin(turn_b)};
  const double area = a_[0] * b_[1] - a_[1] * b_[0];
  inverse_u_ = {b_[1] / area, -b_[0] / area};
  inverse_v_ = {-a_[1] / area, a_[0] / area};
  const auto set = [](double c) { return c != 0; };
  distorted_ = std::any_of(p_.distortion_x_mm.begin(), p_.distortion_x_mm.end(), set) ||
               std::any_of(p_.distortion_y_mm.begin(), p_.distortion_y_mm.end(), set);
}

std::array<double, 2> LensletGeometry::distortion_mm(double x_mm, double y_mm) const noexcept {
  const auto terms = distortion_terms(x_mm / p_.radius_mm, y_mm / p_.radius_mm);
  double dx = 0, dy = 0;
  for (std::size_t k = 0; k < kDistortionTerms; ++k)
    dx += p_.distortion_x_mm[k] * terms[k], dy += p_.distortion_y_mm[k] * terms[k];
  return {dx, dy};
}

std::array<double, 2> LensletGeometry::undistorted_mm(double u, double v) const noexcept {
  return {p_.offset_mm[0] + a_[0] * u + b_[0] * v, p_.offset_mm[1] + a_[1] * u + b_[1] * v};
}

std::array<double, 2> LensletGeometry::position_mm(double u, double v) const noexcept {
  const auto at = undistorted_mm(u, v);
  if (!distorted_) return at;
  const auto d = distortion_mm(at[0], at[1]);
  return {at[0] + d[0], at[1] + d[1]};
}

std::array<double, 2> LensletGeometry::lattice_of(double x_mm, double y_mm) const noexcept {
  double x = x_mm, y = y_mm;
  for (int step = 0; distorted_ && step < 8; ++step) {  // fixed point: the distortion bends by much less than one
    const auto d = distortion_mm(x, y);
    x = x_mm - d[0], y = y_mm - d[1];
  }
  x -= p_.offset_mm[0], y -= p_.offset_mm[1];
  return {inverse_u_[0] * x + inverse_u_[1] * y, inverse_v_[0] * x + inverse_v_[1] * y};
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
  return {reach_mm * (std::abs(inverse_u_[0]) + std::abs(inverse_u_[1])),
          reach_mm * (std::abs(inverse_v_[0]) + std::abs(inverse_v_[1]))};
}

double LensletGeometry::largest_distortion_mm() const noexcept {
  double largest = 0;
  for (int ring = 1; ring <= 4; ++ring)
    for (int k = 0; k < 24; ++k) {
      const double angle = k * std::numbers::pi / 12, radius = p_.radius_mm * ring / 4;
      const auto d = distortion_mm(radius * std::cos(angle), radius * std::sin(angle));
      largest = std::max(largest, std::hypot(d[0], d[1]));
    }
  return largest;
}

}  // namespace rptv
