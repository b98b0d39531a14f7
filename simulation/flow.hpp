// SPDX-License-Identifier: MIT
// Paths of particles without inertia, in closed form: fluid at rest, and above a wall that oscillates in its plane.
#pragma once

#include <memory>
#include <numbers>

#include "simulation/scenario.hpp"

namespace rptv {

/// Position in object space, mm, or velocity, mm/s.
struct Vector3 {
  double x = 0, y = 0, z = 0;
};

/// A flow whose particle paths are known exactly. Object space. Immutable; any thread.
class Flow {
 public:
  virtual ~Flow() = default;
  /// Position at time t of the particle whose mean path passes `rest` at t = 0.
  virtual Vector3 position(const Vector3& rest, double time_s) const noexcept = 0;
  virtual Vector3 velocity(const Vector3& rest, double time_s) const noexcept = 0;
  /// Mean velocity of the particle: how it leaves the lit box, without what only swings to and fro.
  virtual Vector3 drift(const Vector3& rest) const noexcept = 0;
  /// Largest mean velocity along x and z anywhere, with sign: how far upstream particles come from.
  virtual Vector3 largest_drift() const noexcept = 0;
  /// Largest speed of any particle.
  virtual double fastest_mm_s() const noexcept = 0;
};

/// Nothing moves.
class StillFlow : public Flow {
 public:
  Vector3 position(const Vector3& rest, double) const noexcept override { return rest; }
  Vector3 velocity(const Vector3&, double) const noexcept override { return {}; }
  Vector3 drift(const Vector3&) const noexcept override { return {}; }
  Vector3 largest_drift() const noexcept override { return {}; }
  double fastest_mm_s() const noexcept override { return 0; }
};

/// The flow of a scenario's `flow.kind`.
std::unique_ptr<const Flow> make_flow(const ScenarioSettings& scenario);

/// Stokes' second problem plus a uniform drift: u(y, t) = U exp(-k e) cos(w t - k e) along x, with e = y - wall_y >= 0
/// the distance from the wall, k = 1/stokes_layer, U = A w; the drift adds (drift_x, 0, drift_z). y of a particle never
/// changes and u does not depend on x, so that particle paths are exact: x(t) = x0 + A exp(-k e) sin(w t - k e) +
/// drift_x t. Pure functions; any thread.
class OscillatingWallFlow : public Flow {
 public:
  explicit OscillatingWallFlow(const FlowSettings& settings) : settings_(settings) {}

  double omega_rad_s() const noexcept { return 2.0 * std::numbers::pi * settings_.frequency_hz; }
  /// nu = w delta^2 / 2, mm^2/s.
  double viscosity_mm2_s() const noexcept;
  /// Amplitude (mm) and phase (rad, of sin) of the x displacement at height y: A exp(-k e) and -k e.
  double amplitude_mm(double y_mm) const noexcept;
  double phase_rad(double y_mm) const noexcept;
  Vector3 position(const Vector3& rest, double time_s) const noexcept override;
  Vector3 velocity(const Vector3& rest, double time_s) const noexcept override { return velocity(rest.y, time_s); }
  /// Velocity at height y and time t.
  Vector3 velocity(double y_mm, double time_s) const noexcept;
  Vector3 drift(const Vector3&) const noexcept override { return largest_drift(); }
  Vector3 largest_drift() const noexcept override { return {settings_.drift_x_mm_s, 0, settings_.drift_z_mm_s}; }
  double fastest_mm_s() const noexcept override;
  const FlowSettings& settings() const noexcept { return settings_; }

 private:
  FlowSettings settings_;
};

}  // namespace rptv
