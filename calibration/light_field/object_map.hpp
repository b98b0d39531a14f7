// SPDX-License-Identifier: MIT
// From image space to object space and back, with the covariance: thick lens (8-9), telecentric (11), polynomial.
#pragma once

#include <variant>

#include "calibration/light_field/light_field_calibration.hpp"
#include "calibration/light_field/soloff_polynomial.hpp"
#include "calibration/space.hpp"
#include "core/particles.hpp"

namespace rptv {

/// Eq. (8)-(9), inverted: a lens with two principal planes.
struct ThickLens {
  double focal_mm, image_distance_mm, object_distance_mm, index;  ///< EFL, s'_0, s_0, of the medium
  Point3 to_object(const Point3& image) const noexcept;
  Point3 to_image(const Point3& object) const noexcept;
  Matrix3 jacobian(const Point3& image) const noexcept;
  double highest_z_mm() const noexcept { return image_distance_mm - focal_mm; }
};

/// Eq. (11), inverted: a microscope.
struct Telecentric {
  double magnification, index;
  Point3 to_object(const Point3& image) const noexcept;
  Point3 to_image(const Point3& object) const noexcept;
  Matrix3 jacobian(const Point3& image) const noexcept;
  double highest_z_mm() const noexcept;
};

/// What a lens by its data sheet gives, corrected by a polynomial through known points: near to the identity, so that
/// it needs no high order and does not run away outside of them.
struct CorrectedLens {
  std::variant<ThickLens, Telecentric> lens;
  SoloffPolynomial correction;
  Point3 to_object(const Point3& image) const noexcept;
  Point3 to_image(const Point3& object) const noexcept;
  Matrix3 jacobian(const Point3& image) const noexcept;
  double highest_z_mm() const noexcept;
};

/// Image space: origin where the axis meets the array, z towards the main lens. Object space: origin at the conjugate
/// point, x and y parallel to the sensor and not inverted (X_i = -(s'/s)·X; eq. 9 leaves the sign out), z towards the
/// lens, true depth in a medium of index n behind a plane window: Z = n·(s_0 - s). A polynomial's object space is that
/// of the points that it was fitted to. All mm. Immutable; any thread.
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

  /// Images in front of this have no object: the rear focal plane; infinite when telecentric.
  double highest_z_mm() const noexcept;

 private:
  std::variant<ThickLens, Telecentric, CorrectedLens> model_;
};

}  // namespace rptv
