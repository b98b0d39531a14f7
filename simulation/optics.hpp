// SPDX-License-Identifier: MIT
// Where the light of a point in the object goes: thick lens, pupil, lenslets, sensor.
#pragma once

#include <array>
#include <cmath>

#include "calibration/light_field_calibration.hpp"
#include "simulation/flow.hpp"
#include "simulation/scenario.hpp"

namespace rptv {

/// A point of the sensor, px (column, row), pixel centres at integers.
struct SensorPoint {
  double column = 0, row = 0;
};

/// Sequential paraxial optics of one light-field camera. Image space: origin where the axis meets the array, z towards
/// the main lens; object space: origin at the conjugate point, z towards the lens, X_i = -(s'/s) X; mm. Immutable; any
/// thread.
class LightFieldOptics {
 public:
  explicit LightFieldOptics(const ScenarioSettings& scenario);

  /// Image of an object point, eq. (8), (9).
  Vector3 image_of(const Vector3& object) const noexcept;
  double magnification(double object_z_mm) const noexcept;
  double array_distance_mm() const noexcept { return array_distance_; }  ///< behind H2
  double exit_pupil_mm() const noexcept { return exit_pupil_; }          ///< in front of the array
  double exit_pupil_radius_mm() const noexcept { return pupil_radius_; }
  /// Share of a particle's light that enters the lens, 1 at object z = 0 (inverse square to the entrance pupil).
  double brightness(double object_z_mm) const noexcept;

  /// Nearest true lenslet to a point of the array plane, and the lenslet's centre.
  std::array<long, 2> lenslet_at(double x_mm, double y_mm) const noexcept;
  std::array<double, 2> lenslet_centre(std::array<long, 2> lenslet) const noexcept;

  /// Sensor point reached by the ray from the exit pupil's point (px, py) through (towards) the image point.
  SensorPoint trace(const Vector3& image, double pupil_x_mm, double pupil_y_mm) const noexcept;
  /// White-image spot of a lenslet: where the chief ray lands, centre (1 + f/D).
  SensorPoint white_spot(std::array<long, 2> lenslet) const noexcept;
  /// True when every ray of the image point lands on the sensor, `margin_px` away from its border.
  bool fully_in_view(const Vector3& image, double image_radius_mm, double margin_px) const noexcept;

  SensorPoint sensor_point(double x_mm, double y_mm) const noexcept {
    return {x_mm / pixel_mm_ + 0.5 * (width_ - 1), y_mm / pixel_mm_ + 0.5 * (height_ - 1)};
  }
  /// The same camera as the reconstruction reads it.
  LightFieldCalibration calibration() const;

 private:
  ScenarioSettings scenario_;
  double pixel_mm_, width_, height_;
  double array_distance_, exit_pupil_, pupil_radius_;
  double cos_, sin_;
};

}  // namespace rptv
