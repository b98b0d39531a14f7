// SPDX-License-Identifier: MIT
// Flow rate and profile of a duct, from true tracks and from tracks of another flow.
#include "simulation/duct_profile.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/error.hpp"
#include "simulation/duct_flow.hpp"
#include "simulation/tracers.hpp"

namespace rptv {
namespace {

std::vector<TrackRow> true_tracks(const DuctSettings& duct) {
  ScenarioSettings scenario;
  scenario.flow.kind = "duct", scenario.duct = duct, scenario.frames = 20, scenario.rate_hz = 7;
  scenario.seeding.particles = 200;
  scenario.seeding.volume_x_mm = 0.8, scenario.seeding.volume_y_mm = 0.2, scenario.seeding.volume_z_mm = 0.2;
  const Tracers tracers(scenario);
  std::vector<TrackRow> rows;
  for (std::uint64_t frame = 0; frame < 20; ++frame)
    for (const auto& tracer : tracers.lit(frame)) rows.push_back(truth_row(tracer, frame, tracers.time_s(frame)));
  return rows;
}

TEST(DuctProfile, of_true_tracks_is_the_theory) {
  const DuctSettings duct{0.2, 0.2, 0.85};
  const DuctProfile profile = measure_duct_profile(true_tracks(duct), duct);
  EXPECT_NEAR(profile.flow_rate_ul_min, 0.85, 1e-6);
  EXPECT_GT(profile.centre.velocities, 100U);
  EXPECT_GT(profile.corner.velocities, 100U);
  EXPECT_LT(profile.centre.relative, 1e-6);
  EXPECT_LT(profile.corner.relative, 1e-6);
}

TEST(DuctProfile, measures_the_fluid_and_not_the_expectation) {
  const DuctProfile profile = measure_duct_profile(true_tracks({0.2, 0.2, 0.85}), {0.2, 0.2, 1.0});
  EXPECT_NEAR(profile.flow_rate_ul_min, 0.85, 1e-6);
  EXPECT_NEAR(profile.centre.relative, 0.15, 1e-6);
}

TEST(DuctProfile, takes_the_time_from_the_rate_and_refuses_tracks_without_either) {
  const DuctSettings duct{0.2, 0.2, 0.85};
  auto rows = true_tracks(duct);
  for (auto& row : rows) row.t_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NEAR(measure_duct_profile(rows, duct, {.rate_hz = 7}).flow_rate_ul_min, 0.85, 1e-6);
  EXPECT_THROW(measure_duct_profile(rows, duct), Error);
  for (auto& row : rows) row.y_mm += 5;
  EXPECT_THROW(measure_duct_profile(rows, duct, {.rate_hz = 7}), Error);
}

}  // namespace
}  // namespace rptv
