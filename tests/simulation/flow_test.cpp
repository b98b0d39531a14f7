// SPDX-License-Identifier: MIT
// The closed form of Stokes' second problem against its own equation, by finite differences.
#include "simulation/flow.hpp"

#include <gtest/gtest.h>

#include "simulation/tracers.hpp"

namespace rptv {
namespace {

FlowSettings settings() {
  FlowSettings s;
  s.frequency_hz = 7.3;
  s.stokes_layer_mm = 0.83;
  s.wall_amplitude_mm = 0.41;
  return s;
}

TEST(OscillatingWallFlow, velocity_is_the_derivative_of_the_path) {
  const OscillatingWallFlow flow(settings());
  const double h = 1e-6;
  for (double y = -3.5; y <= 3.5; y += 0.7)
    for (double t = 0; t < 0.3; t += 0.017) {
      const auto before = flow.position({0.4, y, -1.0}, t - h), after = flow.position({0.4, y, -1.0}, t + h);
      const auto v = flow.velocity(y, t);
      EXPECT_NEAR((after.x - before.x) / (2 * h), v.x, 1e-5);
      EXPECT_DOUBLE_EQ(after.y, y);
      EXPECT_EQ(v.y, 0.0);
      EXPECT_NEAR((after.z - before.z) / (2 * h), v.z, 1e-6);
    }
}

TEST(OscillatingWallFlow, satisfies_the_diffusion_equation_of_stokes) {
  const OscillatingWallFlow flow(settings());  // du/dt = nu d2u/dy2
  const double ht = 1e-5, hy = 1e-3, nu = flow.viscosity_mm2_s();
  const double scale = flow.omega_rad_s() * flow.omega_rad_s() * settings().wall_amplitude_mm;
  for (double y = -3.4; y <= 3.0; y += 0.4)
    for (double t = 0; t < 0.3; t += 0.013) {
      const double change = (flow.velocity(y, t + ht).x - flow.velocity(y, t - ht).x) / (2 * ht);
      const double curvature =
          (flow.velocity(y + hy, t).x - 2 * flow.velocity(y, t).x + flow.velocity(y - hy, t).x) / (hy * hy);
      EXPECT_NEAR(change, nu * curvature, 2e-5 * scale);
    }
}

TEST(OscillatingWallFlow, sticks_to_the_wall_and_rests_far_above_it) {
  const FlowSettings s = settings();
  const OscillatingWallFlow flow(s);
  EXPECT_NEAR(flow.velocity(s.wall_y_mm, 0).x - s.drift_x_mm_s, s.wall_amplitude_mm * flow.omega_rad_s(), 1e-12);
  EXPECT_NEAR(flow.velocity(s.wall_y_mm + 40 * s.stokes_layer_mm, 0.03).x, s.drift_x_mm_s, 1e-12);
}

TEST(Tracers, keep_the_lit_box_evenly_filled_while_the_fluid_drifts) {
  ScenarioSettings scenario;
  scenario.frames = 400;
  scenario.seeding.particles = 4000;
  scenario.flow.drift_x_mm_s = 1.5;
  scenario.flow.drift_z_mm_s = -0.8;
  const Tracers tracers(scenario);
  for (const std::uint64_t frame : {0U, 200U, 399U}) {
    const auto lit = tracers.lit(frame);
    EXPECT_NEAR(static_cast<double>(lit.size()), 4000, 4 * 64);
    double mean_x = 0, mean_z = 0;
    for (const auto& tracer : lit) {
      mean_x += tracer.position.x / static_cast<double>(lit.size());
      mean_z += tracer.position.z / static_cast<double>(lit.size());
    }
    EXPECT_NEAR(mean_x, 0, 0.15);  // 7 mm / sqrt(12 * 4000) = 0.03 mm
    EXPECT_NEAR(mean_z, 0, 0.15);
  }
}

TEST(Tracers, light_every_particle_in_one_unbroken_run_of_frames) {
  ScenarioSettings scenario;
  scenario.frames = 300;
  scenario.flow.drift_x_mm_s = 2.0;
  scenario.flow.wall_amplitude_mm = 0.5;  // larger than the drift per period
  const Tracers tracers(scenario);
  std::vector<std::uint64_t> frames_lit(tracers.size());
  for (std::uint64_t frame = 0; frame < 300; ++frame)
    for (const auto& tracer : tracers.lit(frame)) {
      EXPECT_EQ(tracer.age_frames, frames_lit[tracer.particle]);
      ++frames_lit[tracer.particle];
    }
}

}  // namespace
}  // namespace rptv
