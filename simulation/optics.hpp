// SPDX-License-Identifier: MIT
// Where the light of a point in the object goes: main lens, lenslets, sensor.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "calibration/light_field/light_field_calibration.hpp"
#include "simulation/lenslet_array.hpp"
#include "simulation/main_lens.hpp"
#include "simulation/scenario.hpp"

namespace rptv {

/// A point of the sensor, px (column, row), pixel centres at integers.
struct SensorPoint {
  double column = 0, row = 0;
};

/// One light-field camera. Image space: origin where the axis meets the array, z towards the main lens; object space:
/// origin at the conjugate point, z towards the lens, X_i = -(s'/s) X; mm. Immutable, cheap to copy; any thread.
class LightFieldOptics {
 public:
  /// Throws Error(no_input, configuration) as make_main_lens() does.
  explicit LightFieldOptics(const ScenarioSettings& scenario);

  const MainLens& lens() const noexcept { return *lens_; }
  const LensletArray& lenslets() const noexcept { return lenslets_; }

  /// Paraxial image of an object point, eq. (8), (9) or (11).
  Vector3 image_of(const Vector3& object) const noexcept { return lens_->first_order().image_of(object); }
  double magnification(double object_z_mm) const noexcept { return lens_->first_order().magnification(object_z_mm); }
  double array_distance_mm() const noexcept { return lens_->first_order().array_distance_mm; }  ///< behind H2
  double exit_pupil_mm() const noexcept {
    return lens_->first_order().exit_pupil_mm;
  }  ///< before the array; 0: infinity
  double exit_pupil_radius_mm() const noexcept { return exit_pupil_mm() * lens_->first_order().cone_slope; }
  double cone_slope() const noexcept { return lens_->first_order().cone_slope; }
  /// Share of a particle's light that enters the lens, 1 at object z = 0.
  double brightness(double object_z_mm) const noexcept;

  /// The point that the real rays of an object point come nearest to: least squares of their distances across the axis,
  /// each ray that passes the lens counting once. None when fewer than three pass.
  std::optional<Vector3> convergence(const Vector3& object) const;

  Lenslet lenslet_at(double x_mm, double y_mm) const noexcept { return lenslets_.at(x_mm, y_mm); }
  std::array<double, 2> lenslet_centre(Lenslet lenslet) const noexcept { return lenslets_.centre(lenslet); }
  /// White-image spot of a lenslet, paraxially: where the chief ray lands, centre (1 + f/D).
  SensorPoint white_spot(Lenslet lenslet) const noexcept;
  /// True when every ray of an ideal image point lands on the sensor, `margin_px` away from its border.
  bool fully_in_view(const Vector3& image, double image_radius_mm, double margin_px) const noexcept;

  SensorPoint sensor_point(const SensorMm& at) const noexcept {
    return {at[0] / pixel_mm_ + 0.5 * (width_ - 1), at[1] / pixel_mm_ + 0.5 * (height_ - 1)};
  }
  /// Mean number of particles in the lit box when the scenario gives it per lenslet, else as the scenario has it.
  std::int64_t particles_in_box() const noexcept;
  /// The same camera as the reconstruction reads it (first order).
  LightFieldCalibration calibration() const;

 private:
  ScenarioSettings scenario_;
  std::shared_ptr<const MainLens> lens_;
  LensletArray lenslets_;
  double pixel_mm_, width_, height_;
};

}  // namespace rptv
