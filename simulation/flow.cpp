// SPDX-License-Identifier: MIT
// Stokes' second problem in closed form, and the choice between flows.
#include "simulation/flow.hpp"

#include <cmath>

#include "simulation/duct_flow.hpp"
#include "simulation/wave_flow.hpp"

namespace rptv {

double OscillatingWallFlow::viscosity_mm2_s() const noexcept {
  return 0.5 * omega_rad_s() * settings_.stokes_layer_mm * settings_.stokes_layer_mm;
}

double OscillatingWallFlow::amplitude_mm(double y_mm) const noexcept {
  return settings_.wall_amplitude_mm * std::exp(-(y_mm - settings_.wall_y_mm) / settings_.stokes_layer_mm);
}

double OscillatingWallFlow::phase_rad(double y_mm) const noexcept {
  return -(y_mm - settings_.wall_y_mm) / settings_.stokes_layer_mm;
}

Vector3 OscillatingWallFlow::position(const Vector3& rest, double time_s) const noexcept {
  const double swing = amplitude_mm(rest.y) * std::sin(omega_rad_s() * time_s + phase_rad(rest.y));
  return {rest.x + swing + settings_.drift_x_mm_s * time_s, rest.y, rest.z + settings_.drift_z_mm_s * time_s};
}

Vector3 OscillatingWallFlow::velocity(double y_mm, double time_s) const noexcept {
  const double w = omega_rad_s();
  return {amplitude_mm(y_mm) * w * std::cos(w * time_s + phase_rad(y_mm)) + settings_.drift_x_mm_s, 0.0,
          settings_.drift_z_mm_s};
}

double OscillatingWallFlow::fastest_mm_s() const noexcept {
  return omega_rad_s() * settings_.wall_amplitude_mm + std::hypot(settings_.drift_x_mm_s, settings_.drift_z_mm_s);
}

std::unique_ptr<const Flow> make_flow(const ScenarioSettings& scenario) {
  if (scenario.flow.kind == "duct") return std::make_unique<DuctFlow>(scenario.duct);
  if (scenario.flow.kind == "oscillating_wall") return std::make_unique<OscillatingWallFlow>(scenario.flow);
  if (scenario.flow.kind == "waves")
    return std::make_unique<WaveFlow>(scenario.waves, scenario.flow, static_cast<std::uint64_t>(scenario.seed));
  return std::make_unique<StillFlow>();
}

}  // namespace rptv
