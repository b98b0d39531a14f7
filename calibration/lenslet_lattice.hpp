// SPDX-License-Identifier: MIT
// Where lenslets are, where their sub-images are, and which pixels belong to which: the two lattices of a light field.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "calibration/light_field_calibration.hpp"

namespace rptv {

/// Lenslet centres lie on the true lattice, offset + pitch·Rot·(iu, iv). The light that the main lens sends through a
/// lenslet lands round its spot, centre·(1 + f/D): pixels belong to lenslets by this apparent lattice, rays start from
/// the true centre. Sensor frame, mm. Covers every lenslet whose sub-image touches the sensor. Immutable; any thread.
class LensletLattice {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffU;

  explicit LensletLattice(const LightFieldCalibration& calibration);

  /// Lenslets are numbered row by row: index = (iv - first_v)·columns + (iu - first_u).
  std::uint32_t columns() const noexcept { return columns_; }
  std::uint32_t rows() const noexcept { return rows_; }
  std::uint32_t size() const noexcept { return columns_ * rows_; }

  /// True centre of a lenslet, mm.
  std::array<float, 2> centre_mm(std::uint32_t index) const noexcept { return centres_[index]; }
  /// Where the chief ray through the lenslet's centre lands on the sensor, mm.
  std::array<double, 2> spot_mm(std::uint32_t index) const noexcept;

  /// Continuous lattice coordinates (column, row from lenslet 0) of a point on the array plane.
  std::array<double, 2> on_true_lattice(double x_mm, double y_mm) const noexcept;
  /// The same of a point on the sensor, by the apparent lattice; rounding gives the lenslet that the pixel belongs to.
  std::array<double, 2> on_apparent_lattice(double x_mm, double y_mm) const noexcept {
    return on_true_lattice(x_mm / scale_, y_mm / scale_);
  }

  /// The lenslets that light on this point of the sensor may have come through, nearest spot first; kNone fills up.
  /// With one hypothesis: the nearest. With more: all whose sub-image covers the point, when the f-number is known.
  void lenslets_of(double x_mm, double y_mm, std::span<std::uint32_t> hypotheses) const noexcept;

  double pitch_mm() const noexcept { return pitch_mm_; }
  double rotation_cosine() const noexcept { return cosine_; }
  double rotation_sine() const noexcept { return sine_; }

 private:
  void cover_sensor(const LightFieldCalibration& calibration);
  std::array<double, 2> centre_of(double column, double row) const noexcept;

  double pitch_mm_, scale_, cosine_, sine_;
  double first_x_mm_, first_y_mm_;  // true centre of lenslet 0
  double subimage_radius_mm_;       // plus half a pixel's diagonal; 0: unknown
  std::uint32_t columns_ = 0, rows_ = 0;
  std::vector<std::array<float, 2>> centres_;
};

}  // namespace rptv
