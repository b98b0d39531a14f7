// SPDX-License-Identifier: MIT
// One damped least-squares step of a particle, what it leaves uncertain, and where its image lies.
#pragma once

#include "calibration/light_field/light_field_calibration.hpp"
#include "reconstruct/light_field/particle_fit.hpp"
#include "reconstruct/light_field/shake_sums.hpp"

namespace rptv {

/// Moves position and light by the Levenberg-Marquardt step (normal + damping·diagonal)⁻¹·pull, bounded. Returns what
/// the linear model promises the step to explain, in χ²; 0 when the equations have no solution.
double take_step(const ShakeSums& sums, double damping, FittedParticle& particle) noexcept;

/// Covariance of the position with the light unknown: the inverse of the normal matrix times `scale` (χ² per pixel),
/// and what an error `border_mm` of the cells' borders on the array makes of it, with rays of rms slope
/// `slope_rms` round the direction `chief` (x, y per z).
FitCovariance covariance_of(const ShakeSums& sums, double scale, double border_mm, double slope_rms,
                            const ImagePoint& chief) noexcept;

/// Chief rays: through the middle of the exit pupil.
class ChiefRay {
 public:
  explicit ChiefRay(const LightFieldCalibration& calibration)
      : per_pupil_distance_(calibration.lens.exit_pupil_mm > 0 ? 1 / calibration.lens.exit_pupil_mm : 0),
        per_pixel_(calibration.apparent_scale() / calibration.pixel_mm()),
        axis_px_(calibration.optical_axis_px()[0]) {}

  /// Column at which the chief ray through a point reaches the sensor, px.
  double operator()(const ImagePoint& at) const noexcept {
    return axis_px_ + at.x / (1 - at.z * per_pupil_distance_) * per_pixel_;
  }
  /// Direction of the chief ray through a point: x and y per z.
  ImagePoint direction(const ImagePoint& at) const noexcept {
    const double per = -per_pupil_distance_ / (1 - at.z * per_pupil_distance_);
    return {at.x * per, at.y * per, 1};
  }
  /// The point at depth z on the same chief ray.
  ImagePoint slide(const ImagePoint& at, double z) const noexcept {
    const double scale = (1 - z * per_pupil_distance_) / (1 - at.z * per_pupil_distance_);
    return {at.x * scale, at.y * scale, z};
  }

 private:
  double per_pupil_distance_, per_pixel_, axis_px_;
};

}  // namespace rptv
