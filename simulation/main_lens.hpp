// SPDX-License-Identifier: MIT
// The seam between particles and microlens array: what a main lens does to light, whatever it is made of.
#pragma once

#include <memory>
#include <span>

#include "simulation/flow.hpp"
#include "simulation/scenario.hpp"

namespace rptv {

/// One ray of a quadrature: a point of the pupil and one of the particle's disc, both in the unit disc.
struct RaySample {
  float pupil_x = 0, pupil_y = 0;
  float body_x = 0, body_y = 0;
};

/// A ray where it crosses the array plane, image space, mm; slopes per unit length in the direction of the light.
struct ArrayRay {
  double x_mm = 0, y_mm = 0;
  double slope_x = 0, slope_y = 0;
  double weight = 0;  ///< 1 on average over a pupil without losses; 0: the ray was lost
};

/// First-order figures of a camera lens that is focused on the array. Image space: origin where the axis meets the
/// array, z towards the lens; object space: origin at the conjugate point, z towards the lens, X_i = -(s'/s) X; mm.
struct FirstOrder {
  double efl_mm = 0;                                 ///< 0: telecentric on both sides (4f)
  double focus_distance_mm = 0;                      ///< focused plane before H1
  double array_distance_mm = 0;                      ///< array behind H2
  double exit_pupil_mm = 0;                          ///< before the array; 0: at infinity
  double cone_slope = 0;                             ///< tangent of half the angle of the cone that reaches the array
  double entrance_pupil_mm = 0;                      ///< behind the focused plane; 0: at infinity
  double fixed_magnification = 0, medium_index = 1;  ///< telecentric only

  /// Paraxial image of an object point: eq. (8), (9) with the sign, or eq. (11).
  Vector3 image_of(const Vector3& object) const noexcept;
  double magnification(double object_z_mm) const noexcept;
  /// Share of a particle's light that enters the lens, 1 at object z = 0 (inverse square to the entrance pupil).
  double brightness(double object_z_mm) const noexcept;
};

/// Immutable; any thread.
class MainLens {
 public:
  explicit MainLens(const FirstOrder& first_order) : first_order_(first_order) {}
  virtual ~MainLens() = default;
  MainLens(const MainLens&) = delete;
  MainLens& operator=(const MainLens&) = delete;

  const FirstOrder& first_order() const noexcept { return first_order_; }
  /// True when all rays of a point meet in first_order().image_of(): nothing needs to be traced to know it.
  virtual bool is_ideal() const noexcept { return false; }
  /// Rays from a disc of radius `body_mm` round the object point, across the axis, to the array plane; the pupil's
  /// samples are turned by `turn_rad`. rays.size() == samples.size().
  virtual void trace(const Vector3& object, double body_mm, std::span<const RaySample> samples, double turn_rad,
                     std::span<ArrayRay> rays) const noexcept = 0;
  /// Rays that arrive within `reach_mm` of a point of the array when the object is evenly bright.
  virtual void white(double x_mm, double y_mm, double reach_mm, std::span<const RaySample> samples,
                     std::span<ArrayRay> rays) const noexcept = 0;

 private:
  FirstOrder first_order_;
};

/// The lens that the scenario asks for. Throws Error(no_input, configuration) for prescriptions that are missing or
/// unfit, or when the particles reach its focal plane. Set-up only.
std::shared_ptr<const MainLens> make_main_lens(const ScenarioSettings& scenario);

/// The scenario with the aperture `share` as wide.
ScenarioSettings stopped_down(const ScenarioSettings& scenario, double share);

}  // namespace rptv
