// SPDX-License-Identifier: MIT
// From image space to object space and back, with the covariance: thick lens (eq. 8-9) and telecentric (eq. 11).
#pragma once

#include <array>

#include "calibration/light_field_calibration.hpp"
#include "core/particles.hpp"

namespace rptv {

using Point3 = std::array<double, 3>;
using Matrix3 = std::array<std::array<double, 3>, 3>;  ///< row, column

/// Image space: origin where the axis meets the array, z towards the main lens. Object space: origin at the conjugate
/// point, x and y parallel to the sensor and not inverted (X_i = -(s'/s)·X; eq. 9 leaves the sign out), z towards the
/// lens, true depth in a medium of index n behind a plane window: Z = n·(s_0 - s). All mm. Immutable; any thread.
class ObjectMap {
 public:
  /// Throws Error(configuration) when the calibration is not valid.
  explicit ObjectMap(const LightFieldCalibration& calibration);

  /// Defined for z < highest_z_mm().
  Point3 to_object(const Point3& image) const noexcept;
  Point3 to_image(const Point3& object) const noexcept;
  /// d(object)/d(image) at a point of image space.
  Matrix3 jacobian(const Point3& image) const noexcept;
  /// J·C·Jᵀ.
  Covariance to_object(const Covariance& image, const Matrix3& jacobian) const noexcept;

  /// Images in front of this have no object: the rear focal plane (infinite when telecentric).
  double highest_z_mm() const noexcept;

 private:
  bool telecentric_;
  double focal_mm_, image_distance_mm_, object_distance_mm_;  // EFL, s'_0, s_0
  double magnification_, index_;
};

}  // namespace rptv
