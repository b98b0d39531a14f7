// SPDX-License-Identifier: MIT
// Amplitude and phase above the wall, recovered from true and from noisy tracks.
#include "simulation/wall_profile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/csv.hpp"
#include "core/error.hpp"
#include "simulation/random.hpp"
#include "simulation/tracers.hpp"

namespace rptv {
namespace {

ScenarioSettings scene() {
  ScenarioSettings scenario;
  scenario.frames = 120;
  scenario.seeding.particles = 150;
  return scenario;
}

std::vector<TrackRow> true_tracks(const ScenarioSettings& scenario, double noise_mm = 0) {
  const Tracers tracers(scenario);
  Random random(9, 9);
  std::vector<TrackRow> rows;
  for (std::uint64_t frame = 0; frame < static_cast<std::uint64_t>(scenario.frames); ++frame)
    for (const auto& tracer : tracers.lit(frame)) {
      rows.push_back(truth_row(tracer, frame, tracers.time_s(frame)));
      rows.back().x_mm += noise_mm * static_cast<double>(normal_table()[random.bits() & 0xffff]);
    }
  return rows;
}

TEST(WallProfile, recovers_the_theory_from_true_tracks_within_a_thousandth) {
  const auto scenario = scene();
  const auto profile = measure_wall_profile(true_tracks(scenario), scenario.flow);
  EXPECT_GE(profile.bins.size(), 12U);
  for (const auto& bin : profile.bins) {
    EXPECT_NEAR(bin.amplitude_mm, bin.theory_amplitude_mm, 1e-3 * scenario.flow.wall_amplitude_mm);
    EXPECT_NEAR(bin.phase_rad, bin.theory_phase_rad, 1e-3);
    EXPECT_NEAR(bin.theory_phase_rad, -bin.height_mm / scenario.flow.stokes_layer_mm, 0.05);
  }
  EXPECT_LT(profile.amplitude_rms_relative, 1e-3);
  EXPECT_NEAR(profile.wall_amplitude_mm, scenario.flow.wall_amplitude_mm, 1e-3 * scenario.flow.wall_amplitude_mm);
  EXPECT_NEAR(profile.stokes_layer_mm, scenario.flow.stokes_layer_mm, 1e-3 * scenario.flow.stokes_layer_mm);
  EXPECT_NEAR(profile.wall_phase_rad, 0, 1e-3);
}

TEST(WallProfile, measures_the_fluid_and_not_the_expectation) {
  const auto scenario = scene();
  FlowSettings expected = scenario.flow;
  expected.stokes_layer_mm = 1.7;
  expected.wall_amplitude_mm = 0.2;
  const auto profile = measure_wall_profile(true_tracks(scenario), expected);
  EXPECT_NEAR(profile.stokes_layer_mm, 1.0, 1e-3);
  EXPECT_NEAR(profile.wall_amplitude_mm, 0.3, 3e-4);
  EXPECT_GT(profile.amplitude_rms_relative, 0.05);
}

TEST(WallProfile, sees_the_wall_start_later) {
  const auto scenario = scene();
  WallProfileSettings settings;
  settings.start_s = 0.01;  // 5 Hz: 0.314 rad
  const auto profile = measure_wall_profile(true_tracks(scenario), scenario.flow, settings);
  EXPECT_NEAR(profile.wall_phase_rad, 2 * M_PI * 5 * 0.01, 1e-3);
}

TEST(WallProfile, states_errors_that_cover_noisy_tracks) {
  const auto scenario = scene();
  const auto profile = measure_wall_profile(true_tracks(scenario, 0.02), scenario.flow);
  int covered = 0;
  for (const auto& bin : profile.bins) {
    EXPECT_GT(bin.amplitude_sigma_mm, 0.02 * std::sqrt(2.0 / static_cast<double>(bin.points)) * 0.8);
    covered += std::abs(bin.amplitude_mm - bin.theory_amplitude_mm) < 3 * bin.amplitude_sigma_mm;
  }
  EXPECT_GE(covered, static_cast<int>(profile.bins.size()) - 1);
  EXPECT_NEAR(profile.stokes_layer_mm, 1.0, 0.01);
}

// Off the axis an error of depth moves a particle along its line of sight: 20 um of depth by 1 um of x.
TEST(WallProfile, takes_what_depth_errors_do_to_x_out_of_it) {
  const auto scenario = scene();
  auto rows = true_tracks(scenario, 1e-4), level = rows;
  Random random(4, 4);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double error_mm = 0.02 * static_cast<double>(normal_table()[random.bits() & 0xffff]);
    rows[i].z_mm += error_mm, rows[i].x_mm += 0.05 * error_mm;
    level[i].x_mm += 0.05 * error_mm;  // the same, and nobody tells
  }
  const auto profile = measure_wall_profile(rows, scenario.flow), untold = measure_wall_profile(level, scenario.flow);
  ASSERT_EQ(profile.bins.size(), untold.bins.size());
  int covered = 0;
  for (std::size_t k = 0; k < profile.bins.size(); ++k) {
    const auto& bin = profile.bins[k];
    EXPECT_LT(bin.amplitude_sigma_mm, 0.2 * untold.bins[k].amplitude_sigma_mm);
    covered += std::abs(bin.amplitude_mm - bin.theory_amplitude_mm) < 3 * bin.amplitude_sigma_mm;
  }
  EXPECT_GE(covered, static_cast<int>(profile.bins.size()) - 1);
}

TEST(WallProfile, joins_layers_whose_phase_is_unsure_with_those_below) {
  const auto scenario = scene();
  const auto rows = true_tracks(scenario, 0.02);
  constexpr double kMost_rad = 3 * M_PI / 180;
  const auto is_sure = [](const WallProfileBin& bin) {
    return bin.amplitude_sigma_mm <= kMost_rad * bin.theory_amplitude_mm;
  };
  WallProfileSettings settings;
  const auto apart = measure_wall_profile(rows, scenario.flow, settings);
  settings.most_phase_sigma_deg = 3;
  const auto joined = measure_wall_profile(rows, scenario.flow, settings);
  EXPECT_FALSE(std::all_of(apart.bins.begin(), apart.bins.end(), is_sure));
  EXPECT_TRUE(std::all_of(joined.bins.begin(), joined.bins.end(), is_sure));
  std::uint64_t tracks_apart = 0, tracks_joined = 0;
  for (const auto& bin : apart.bins) tracks_apart += bin.tracks;
  for (const auto& bin : joined.bins) {
    tracks_joined += bin.tracks;
    EXPECT_LE(std::abs(bin.phase_rad - bin.theory_phase_rad), 3 * bin.amplitude_sigma_mm / bin.theory_amplitude_mm);
  }
  EXPECT_EQ(tracks_joined, tracks_apart);
}

TEST(WallProfile, takes_time_from_the_frame_rate_when_tracks_have_none) {
  const auto scenario = scene();
  auto rows = true_tracks(scenario);
  for (auto& row : rows) row.t_s = kNoTime;
  EXPECT_THROW(measure_wall_profile(rows, scenario.flow), Error);
  WallProfileSettings settings;
  settings.rate_hz = scenario.rate_hz;
  EXPECT_NEAR(measure_wall_profile(rows, scenario.flow, settings).stokes_layer_mm, 1.0, 1e-3);
}

TEST(WallProfile, refuses_tracks_shorter_than_a_period) {
  auto scenario = scene();
  scenario.frames = 15;  // 0.15 s of a 0.2 s period
  EXPECT_THROW(measure_wall_profile(true_tracks(scenario), scenario.flow), Error);
}

TEST(WallProfile, is_written_as_a_table) {
  const auto scenario = scene();
  const auto profile = measure_wall_profile(true_tracks(scenario), scenario.flow);
  const std::string file = testing::TempDir() + "/profile.csv";
  write_wall_profile(profile, file);
  CsvReader csv(file, {{"height_mm"}, {"amplitude_mm"}, {"theory_phase_rad"}, {"tracks"}});
  std::size_t rows = 0;
  while (csv.next()) {
    EXPECT_EQ(csv.number(0), profile.bins[rows].height_mm);
    EXPECT_EQ(csv.number(1), profile.bins[rows].amplitude_mm);
    EXPECT_EQ(csv.number(2), profile.bins[rows].theory_phase_rad);
    EXPECT_EQ(csv.index(3), profile.bins[rows].tracks);
    ++rows;
  }
  EXPECT_EQ(rows, profile.bins.size());
}

}  // namespace
}  // namespace rptv
