// SPDX-License-Identifier: MIT
// Where lenslets are, where their sub-images are, and which pixels belong to which: the two lattices of a light field.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "calibration/light_field/lenslet_geometry.hpp"
#include "calibration/light_field/light_field_calibration.hpp"

namespace rptv {

/// Lenslet centres lie on the true lattice (LensletGeometry: square or hexagonal, distorted). The light that the main
/// lens sends through a lenslet lands round its spot, centre·(1 + f/D): pixels belong to lenslets by this apparent
/// lattice, rays start from the true centre. Sensor frame, mm. Covers every lenslet whose sub-image touches the sensor.
/// Immutable; any thread.
class LensletLattice {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffU;

  explicit LensletLattice(const LightFieldCalibration& calibration);

  /// Lenslets are numbered row by row: index = row·columns + column = (iv - first_v)·columns + (iu - first_u).
  std::uint32_t columns() const noexcept { return columns_; }
  std::uint32_t rows() const noexcept { return rows_; }
  std::uint32_t size() const noexcept { return columns_ * rows_; }

  /// True centre of a lenslet, mm.
  std::array<float, 2> centre_mm(std::uint32_t index) const noexcept { return centres_[index]; }
  /// Where the chief ray through the lenslet's centre lands on the sensor, mm.
  std::array<double, 2> spot_mm(std::uint32_t index) const noexcept;
  /// Why this lenslet gives no rays (lenslet_reason bits); 0: it does.
  std::uint8_t masked(std::uint32_t index) const noexcept { return masked_.empty() ? std::uint8_t{0} : masked_[index]; }

  /// How bright the pixels of a sub-image are in even light, over those on the axis: the light through the lenslet over
  /// the area of its sub-image, since a rim that cuts it leaves the rest as bright. 0: unknown.
  float brightness(std::uint32_t index) const noexcept { return brightness_.empty() ? 0.0F : brightness_[index]; }

  /// Continuous lattice coordinates (column, row from lenslet 0) of a point on the array plane.
  std::array<double, 2> on_true_lattice(double x_mm, double y_mm) const noexcept;
  /// The lattice that on_true_lattice() asks, and the numbers in it of lenslet 0.
  const LatticeInverse& inverse() const noexcept { return geometry_.inverse(); }
  std::array<double, 2> first() const noexcept { return {first_u_, first_v_}; }
  /// The same of a point on the sensor, by the apparent lattice.
  std::array<double, 2> on_apparent_lattice(double x_mm, double y_mm) const noexcept {
    return on_true_lattice(x_mm / scale_, y_mm / scale_);
  }
  /// How many columns and rows away lenslets within ±reach_mm along x and y can be.
  std::array<double, 2> reach(double reach_mm) const noexcept { return geometry_.reach(reach_mm); }

  /// The lenslets that light on this point of the sensor may have come through, nearest spot first; kNone fills up.
  /// With one hypothesis: the nearest. With more: all whose sub-image covers the point, when the f-number is known.
  /// Masked lenslets are left out.
  void lenslets_of(double x_mm, double y_mm, std::span<std::uint32_t> hypotheses) const noexcept;

  double pitch_mm() const noexcept { return geometry_.parameters().pitch_mm; }
  double rotation_cosine() const noexcept { return std::cos(geometry_.parameters().rotation_rad); }
  double rotation_sine() const noexcept { return std::sin(geometry_.parameters().rotation_rad); }

 private:
  void cover_sensor(const LightFieldCalibration& calibration);

  LensletGeometry geometry_;
  double scale_;
  double subimage_radius_mm_;  // plus half a pixel's diagonal; 0: unknown
  double first_u_ = 0, first_v_ = 0;
  std::uint32_t columns_ = 0, rows_ = 0;
  std::vector<std::array<float, 2>> centres_;
  std::vector<std::uint8_t> masked_;  // empty: none
  std::vector<float> brightness_;     // empty: unknown
};

}  // namespace rptv
