// SPDX-License-Identifier: MIT
// Flow rate and profile of a duct, recovered from true, noisy and wrong tracks.
#include "simulation/duct_profile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/csv.hpp"
#include "core/error.hpp"
#include "simulation/duct_flow.hpp"
#include "simulation/random.hpp"
#include "simulation/score_report.hpp"
#include "tests/proto/place.hpp"

namespace rptv {
namespace {

constexpr double kPeriod_s = 0.1;

/// Tracks of five points, side² of them all over the duct's cross-section; the last frame first.
std::vector<TrackRow> tracks_in(const DuctSettings& duct, std::uint64_t side, double noise_mm, unsigned seed) {
  const DuctFlow flow(duct);
  Random random(seed, 1);
  const auto noise = [&] { return noise_mm * static_cast<double>(normal_table()[random.bits() & 0xffff]); };
  std::vector<TrackRow> rows;
  for (std::uint64_t particle = 0; particle < side * side; ++particle) {
    const auto share = [&](std::uint64_t i) {
      return (static_cast<double>(i) + 0.6) / static_cast<double>(side) - 0.5;
    };
    const double y = duct.width_mm * share(particle % side), z = duct.height_mm * share(particle / side);
    const double velocity = flow.velocity_mm_s(y, z);
    for (std::uint64_t frame = 5; frame-- > 0;) {
      const double t_s = kPeriod_s * static_cast<double>(frame);
      rows.push_back({frame, particle, velocity * t_s + noise(), y, z, 0, 0, 0, 0, 0, t_s});
    }
  }
  return rows;
}

TEST(DuctProfile, is_the_theory_s_for_true_tracks) {
  const DuctSettings duct{0.2, 0.1, 0.85};
  const DuctProfile profile = measure_duct_profile(tracks_in(duct, 30, 0, 1), duct);
  EXPECT_EQ(profile.steps, 3600U);
  EXPECT_NEAR(profile.flow_rate_ul_min, 0.85, 1e-9);
  EXPECT_NEAR(profile.centre_deviation, 0, 1e-9);
  EXPECT_NEAR(profile.wall_deviation, 0, 1e-9);
  ASSERT_EQ(profile.bins.size(), 10U);
  std::uint64_t steps = 0;
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_NEAR(profile.bins[i].velocity_mm_s, profile.bins[i].theory_mm_s, 1e-12);
    EXPECT_GT(profile.bins[i].theory_mm_s, i == 0 ? 0 : profile.bins[i - 1].theory_mm_s);
    steps += profile.bins[i].steps;
  }
  EXPECT_EQ(steps, profile.steps);
}

TEST(DuctProfile, measures_the_fluid_and_not_the_expectation) {
  const DuctSettings real{0.2, 0.2, 1.0};
  const DuctProfile profile = measure_duct_profile(tracks_in(real, 30, 0, 1), {0.2, 0.2, 0.8});
  EXPECT_NEAR(profile.flow_rate_ul_min, 1.0, 1e-9);
  EXPECT_NEAR(profile.centre_deviation, 0.25, 1e-9);
  EXPECT_NEAR(profile.wall_deviation, 0.25, 1e-9);
}

TEST(DuctProfile, has_an_honest_standard_error) {
  const DuctSettings duct{0.2, 0.2, 0.85};
  double square = 0;
  constexpr unsigned kRuns = 300;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const DuctProfile profile = measure_duct_profile(tracks_in(duct, 15, 0.004, seed), duct);
    square += std::pow((profile.flow_rate_ul_min - 0.85) / profile.flow_rate_sigma_ul_min, 2);
  }
  EXPECT_NEAR(square / kRuns, 1, 0.25);  // three standard deviations of such a mean
}

TEST(DuctProfile, takes_times_from_frames_and_refuses_tracks_without_any) {
  const DuctSettings duct{0.2, 0.2, 0.85};
  auto rows = tracks_in(duct, 30, 0, 1);
  for (auto& row : rows) row.t_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NEAR(measure_duct_profile(rows, duct, 1 / kPeriod_s).flow_rate_ul_min, 0.85, 1e-9);
  EXPECT_THROW(measure_duct_profile(rows, duct), Error);
  EXPECT_THROW(measure_duct_profile({}, duct), Error);
  for (auto& row : rows) row.y_mm += 5;
  EXPECT_THROW(measure_duct_profile(rows, duct, 1), Error);
}

TEST(DuctProfile, is_told_as_text_json_and_table) {
  const DuctSettings duct{0.2, 0.2, 0.85};
  const auto rows = tracks_in(duct, 30, 0, 1);
  const DuctProfile profile = measure_duct_profile(rows, duct);
  EXPECT_NE(to_text(profile).find("flow rate 0.8500 ul/min"), std::string::npos);
  EXPECT_EQ(to_json(profile).rfind("{\"steps\":3600,\"flow_rate_ul_min\":0.8", 0), 0U);
  const Place place;
  write_duct_profile(profile, place.file("profile.csv"));
  CsvReader csv(place.file("profile.csv"), {{"theory_mm_s"}, {"steps"}});
  std::size_t bins = 0;
  for (; csv.next(); ++bins) EXPECT_EQ(csv.number(0), profile.bins[bins].theory_mm_s);
  EXPECT_EQ(bins, profile.bins.size());
}

}  // namespace
}  // namespace rptv
