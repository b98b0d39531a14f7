// SPDX-License-Identifier: MIT
// Stokes' second problem: the layer of fluid above a wall that oscillates in its own plane, plus a uniform drift.
#pragma once

#include <numbers>

#include "simulation/scenario.hpp"

namespace rptv {

/// Position in object space, mm, or velocity, mm/s.
struct Vector3 {
  double x = 0, y = 0, z = 0;
};

/// u(y, t) = U exp(-k e) cos(w t - k e) along x, with e = y - wall_y >= 0 the distance from the wall, k =
/// 1/stokes_layer, U = A w; the drift adds (drift_x, 0, drift_z). y of a particle never changes and u does not depend
/// on x, so that particle paths are exact: x(t) = x0 + A exp(-k e) sin(w t - k e) + drift_x t. Pure functions; any
/// thread.
class OscillatingWallFlow {
 public:
  explicit OscillatingWallFlow(const FlowSettings& settings) : settings_(settings) {}

  double omega_rad_s() const noexcept { return 2.0 * std::numbers::pi * settings_.frequency_hz; }
  /// nu = w delta^2 / 2, mm^2/s.
  double viscosity_mm2_s() const noexcept;
  /// Amplitude (mm) and phase (rad, of sin) of the x displacement at height y: A exp(-k e) and -k e.
  double amplitude_mm(double y_mm) const noexcept;
  double phase_rad(double y_mm) const noexcept;
  /// Position at time t of the particle whose mean path passes `rest` at t = 0.
  Vector3 position(const Vector3& rest, double time_s) const noexcept;
  /// Velocity at height y and time t.
  Vector3 velocity(double y_mm, double time_s) const noexcept;
  const FlowSettings& settings() const noexcept { return settings_; }

 private:
  FlowSettings settings_;
};

}  // namespace rptv
