// SPDX-License-Identifier: MIT
// Laminar duct flow: its series against walls, flow rate, the literature and the equation it solves.
#include "simulation/duct_flow.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/tracers.hpp"

namespace rptv {
namespace {

/// Gauss-Legendre with 5 points on `cells` cells.
template <class Function>
double integral(double low, double high, int cells, Function function) {
  constexpr double kAt[] = {0, 0.5384693101056831, 0.9061798459386640};
  constexpr double kWeight[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  double sum = 0;
  const double half = 0.5 * (high - low) / cells;
  for (int cell = 0; cell < cells; ++cell) {
    const double middle = low + (2 * cell + 1) * half;
    sum += kWeight[0] * function(middle);
    for (int i = 1; i < 3; ++i)
      sum += kWeight[i] * (function(middle - kAt[i] * half) + function(middle + kAt[i] * half));
  }
  return sum * half;
}

TEST(DuctFlow, carries_the_flow_rate) {
  for (const auto& [width, height] : {std::pair{0.2, 0.2}, {0.5, 0.2}, {0.1, 0.4}}) {
    const DuctFlow flow({width, height, 0.85});
    const double rate = integral(-width / 2, width / 2, 12, [&](double y) {
      return integral(-height / 2, height / 2, 12, [&](double z) { return flow.velocity_mm_s(y, z); });
    });
    EXPECT_NEAR(rate * 60, 0.85, 1e-5 * 0.85);  // mm^3/s to ul/min
    EXPECT_NEAR(flow.mean_mm_s() * width * height * 60, 0.85, 1e-12);
  }
}

TEST(DuctFlow, is_at_rest_on_every_wall) {
  const DuctFlow flow({0.2, 0.3, 0.85});
  for (double s = -1; s <= 1; s += 0.125) {
    EXPECT_EQ(flow.velocity_mm_s(0.1, 0.15 * s), 0);
    EXPECT_EQ(flow.velocity_mm_s(0.1 * s, -0.15), 0);
    EXPECT_NEAR(flow.velocity_mm_s(0.1 - 1e-9, 0.15 * s), 0, 1e-5 * flow.mean_mm_s());
    EXPECT_NEAR(flow.velocity_mm_s(0.1 * s, 0.15 - 1e-9), 0, 1e-5 * flow.mean_mm_s());
  }
}

TEST(DuctFlow, has_converged) {
  const DuctFlow flow({0.2, 0.2, 0.85}), longer({0.2, 0.2, 0.85}, 1000);
  for (double y = -0.099; y < 0.1; y += 0.011)
    for (double z = -0.099; z < 0.1; z += 0.011)
      EXPECT_NEAR(flow.velocity_mm_s(y, z), longer.velocity_mm_s(y, z), 1e-5 * flow.mean_mm_s());
}

TEST(DuctFlow, has_the_peak_that_the_literature_gives) {
  EXPECT_NEAR(DuctFlow({0.2, 0.2, 1}).fastest_mm_s() / DuctFlow({0.2, 0.2, 1}).mean_mm_s(), 2.0962, 1e-4);  // square
  EXPECT_NEAR(DuctFlow({2, 200, 1}).fastest_mm_s() / DuctFlow({2, 200, 1}).mean_mm_s(), 1.5, 0.01);         // slot
  const DuctFlow seed({0.2, 0.2, 0.85});  // the proposal's channel, as the data set lf-microchannel states it
  EXPECT_NEAR(seed.mean_mm_s(), 0.3541666666666666, 1e-12);
  EXPECT_NEAR(seed.fastest_mm_s(), 0.7424237958306305, 2e-6);
}

TEST(DuctFlow, obeys_stokes_equation) {  // the Laplacian of u is the same everywhere
  const DuctFlow flow({0.2, 0.3, 0.85}, 200);
  const auto laplacian = [&](double y, double z) {
    constexpr double kStep = 2e-3;
    return (flow.velocity_mm_s(y + kStep, z) + flow.velocity_mm_s(y - kStep, z) + flow.velocity_mm_s(y, z + kStep) +
            flow.velocity_mm_s(y, z - kStep) - 4 * flow.velocity_mm_s(y, z)) /
           (kStep * kStep);
  };
  const double middle = laplacian(0, 0);
  EXPECT_LT(middle, 0);
  for (const auto& [y, z] : {std::pair{0.03, 0.05}, {-0.06, 0.1}, {0.05, -0.12}})
    EXPECT_NEAR(laplacian(y, z), middle, 2e-3 * -middle);
}

TEST(DuctFlow, does_not_care_which_side_is_called_width) {
  const DuctFlow wide({0.4, 0.1, 1}), high({0.1, 0.4, 1});
  for (const auto& [a, b] : {std::pair{0.0, 0.0}, {0.15, 0.02}, {-0.19, 0.045}})
    EXPECT_NEAR(wide.velocity_mm_s(a, b), high.velocity_mm_s(b, a), 1e-5 * wide.mean_mm_s());
}

ScenarioSettings duct_scene() {
  ScenarioSettings s;
  s.flow.kind = "duct";
  s.seeding.volume_x_mm = 0.6;
  s.seeding.volume_y_mm = s.seeding.volume_z_mm = 0.2;
  s.seeding.particles = 300;
  s.rate_hz = 7;
  s.frames = 35;
  return s;
}

TEST(Tracers, flow_through_the_duct_and_stay_evenly_seeded) {
  const Tracers tracers(duct_scene());
  const DuctFlow flow(duct_scene().duct);
  for (const std::uint64_t frame : {0U, 17U, 34U}) {
    const auto lit = tracers.lit(frame);
    EXPECT_NEAR(static_cast<double>(lit.size()), 300, 60);
    double x = 0;
    for (const auto& tracer : lit) {
      x += tracer.position.x;
      EXPECT_LE(std::abs(tracer.position.x), 0.3);
      EXPECT_LE(std::abs(tracer.position.y), 0.1);
      EXPECT_DOUBLE_EQ(tracer.velocity.x, flow.velocity_mm_s(tracer.position.y, tracer.position.z));
    }
    EXPECT_NEAR(x / static_cast<double>(lit.size()), 0, 0.04);  // 4 sigma
  }
}

TEST(Tracers, layers_are_where_they_are_told_and_stay) {
  ScenarioSettings s;
  s.flow.kind = "layers";
  const Tracers tracers(s);
  const auto first = tracers.lit(0), later = tracers.lit(9);
  ASSERT_EQ(first.size(), 45U);
  for (std::size_t i = 0; i < 45; ++i) {
    EXPECT_EQ(first[i].position.z, s.layers.z_mm[i / 15]);
    EXPECT_EQ(first[i].position.x, later[i].position.x);
    EXPECT_EQ(later[i].age_frames, 9U);
  }
}

TEST(Tracers, random_ones_are_new_in_every_frame) {
  ScenarioSettings s;
  s.flow.kind = "random";
  const Tracers tracers(s);
  const auto first = tracers.lit(0), second = tracers.lit(1), again = Tracers(s).lit(1);
  ASSERT_EQ(first.size(), 200U);
  EXPECT_EQ(second[0].particle, 200U);
  EXPECT_NE(first[0].position.x, second[0].position.x);
  EXPECT_EQ(second[7].position.z, again[7].position.z);
}

}  // namespace
}  // namespace rptv
