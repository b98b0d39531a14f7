// SPDX-License-Identifier: MIT
// A plane lattice with a smooth distortion: from lattice numbers to millimetres and back.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "calibration/light_field/lattice_inverse.hpp"

namespace rptv {

/// What fixes a lattice. Frame: mm, origin on the optical axis, x along columns, y along rows.
struct LatticeParameters {
  std::string shape = "square";       ///< "square", or "hexagonal": a row every √3/2 pitches, shifted by half a pitch
  double pitch_mm = 0;                ///< between neighbours
  double rotation_rad = 0;            ///< of the rows of neighbours against the sensor's rows
  std::array<double, 2> offset_mm{};  ///< where (0, 0) would be without distortion
  double radius_mm = 1;               ///< unit of length of the distortion: half the sensor's diagonal
  std::array<double, kDistortionTerms> distortion_x_mm{}, distortion_y_mm{};
};

/// Position (u, v) = offset + pitch·Rot·(u·a + v·b) + distortion, with a = (1, 0) and b = (0, 1) (square) or
/// (1/2, √3/2) (hexagonal). Immutable; any thread; nothing allocates after construction.
class LensletGeometry {
 public:
  explicit LensletGeometry(const LatticeParameters& parameters);

  /// Position of lattice point (u, v), mm; with and without distortion. u and v may be fractions.
  std::array<double, 2> position_mm(double u, double v) const noexcept;
  std::array<double, 2> undistorted_mm(double u, double v) const noexcept;
  /// The inverse of position_mm.
  const LatticeInverse& inverse() const noexcept { return inverse_; }
  std::array<double, 2> lattice_of(double x_mm, double y_mm) const noexcept { return inverse_.lattice_of(x_mm, y_mm); }
  /// Lattice point next to a position, by distance on the undistorted lattice.
  std::array<double, 2> nearest_of(double x_mm, double y_mm) const noexcept;
  /// Square of the distance in pitches that two lattice points differ by.
  double distance2(double du, double dv) const noexcept { return du * du + (dv * dv + 2 * cosine_between_ * du * dv); }
  /// Largest |du| and |dv| of points within ±reach of a point along x and y.
  std::array<double, 2> reach(double reach_mm) const noexcept;
  /// Largest shift that the distortion makes within the unit circle about the axis, mm.
  double largest_distortion_mm() const noexcept;

  const LatticeParameters& parameters() const noexcept { return p_; }

 private:
  LatticeParameters p_;
  double cosine_between_;            // of the angle between a and b
  std::array<double, 2> a_{}, b_{};  // mm
  LatticeInverse inverse_;
};

}  // namespace rptv
