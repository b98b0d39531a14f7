// SPDX-License-Identifier: MIT
// From millimetres to lattice numbers. All of it constexpr, so that nvcc compiles it for the device, too.
#pragma once

#include <array>
#include <cstddef>

namespace rptv {

/// Terms of the distortion: x, y, x², xy, y², x³, x²y, xy², y³ of the undistorted position over `radius_mm`.
inline constexpr std::size_t kDistortionTerms = 9;
constexpr std::array<double, kDistortionTerms> distortion_terms(double x, double y) noexcept {
  return {x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y};
}

/// The inverse of LensletGeometry::position_mm(), to 1e-9 pitches for distortions that bend the lattice by less than a
/// tenth. Frame: that of LatticeParameters.
struct LatticeInverse {
  std::array<double, 2> offset_mm{}, per_mm_u{}, per_mm_v{};
  double radius_mm = 1;
  std::array<double, kDistortionTerms> distortion_x_mm{}, distortion_y_mm{};
  bool distorted = false;

  /// What the distortion adds at an undistorted position, mm.
  constexpr std::array<double, 2> distortion_mm(double x_mm, double y_mm) const noexcept {
    const auto terms = distortion_terms(x_mm / radius_mm, y_mm / radius_mm);
    double dx = 0, dy = 0;
    for (std::size_t k = 0; k < kDistortionTerms; ++k)
      dx += distortion_x_mm[k] * terms[k], dy += distortion_y_mm[k] * terms[k];
    return {dx, dy};
  }
  /// Lattice numbers (u, v) of a position, in general fractions.
  constexpr std::array<double, 2> lattice_of(double x_mm, double y_mm) const noexcept {
    double x = x_mm, y = y_mm;
    for (int step = 0; distorted && step < 8; ++step) {  // fixed point: the distortion bends by much less than one
      const auto d = distortion_mm(x, y);
      x = x_mm - d[0], y = y_mm - d[1];
    }
    x -= offset_mm[0], y -= offset_mm[1];
    return {per_mm_u[0] * x + per_mm_u[1] * y, per_mm_v[0] * x + per_mm_v[1] * y};
  }
};

}  // namespace rptv
