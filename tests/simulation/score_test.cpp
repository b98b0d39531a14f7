// SPDX-License-Identifier: MIT
// Scores of hand-made cases, and what must hold for any case.
#include "simulation/score.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>

#include "core/error.hpp"
#include "simulation/score_report.hpp"

namespace rptv {
namespace {

TrackRow row(std::uint64_t frame, std::uint64_t particle, double x, double y = 0, double z = 0) {
  TrackRow r;
  r.frame = frame;
  r.particle = particle;
  r.x_mm = x;
  r.y_mm = y;
  r.z_mm = z;
  return r;
}

TruthRow real(std::uint64_t frame, std::uint64_t particle, double x, double y = 0, double z = 0, bool in_view = true) {
  TruthRow r;
  static_cast<TrackRow&>(r) = row(frame, particle, x, y, z);
  r.in_view = in_view;
  return r;
}

const ScoreSettings kVoxel{{0.1, 0.1, 0.5}};

TEST(Score, counts_true_positives_ghosts_and_misses) {
  const std::vector<TruthRow> truth{real(0, 0, 0), real(0, 1, 1), real(0, 2, 2), real(0, 3, 3, 0, 0, false)};
  const Measurement measured{{row(0, 0, 0.05), row(0, 0, 1, 0, 0.4), row(0, 0, 2.11), row(0, 0, 3)}, false};
  const auto d = score(measured, truth, kVoxel).detection;
  EXPECT_EQ(d.truth, 3U);
  EXPECT_EQ(d.found, 2U);
  EXPECT_EQ(d.ghosts, 1U);          // 2.11 is 0.11 mm off
  EXPECT_EQ(d.partly_visible, 1U);  // 3 was no duty and is no ghost
  EXPECT_DOUBLE_EQ(d.recall, 2.0 / 3);
  EXPECT_DOUBLE_EQ(d.precision, 3.0 / 4);
}

TEST(Score, gives_one_truth_to_one_measured_the_nearest) {
  const std::vector<TruthRow> truth{real(0, 0, 0)};
  const Measurement measured{{row(0, 0, 0.05), row(0, 1, 0.02)}, false};
  const auto d = score(measured, truth, kVoxel).detection;
  EXPECT_EQ(d.found, 1U);
  EXPECT_EQ(d.ghosts, 1U);
  EXPECT_NEAR(d.position_mm.mean[0], 0.02, 1e-15);
}

TEST(Score, takes_each_axis_with_its_own_radius) {
  const std::vector<TruthRow> truth{real(0, 0, 0)};
  EXPECT_EQ(score({{row(0, 0, 0, 0, 0.45)}, false}, truth, kVoxel).detection.found, 1U);
  EXPECT_EQ(score({{row(0, 0, 0, 0.45, 0)}, false}, truth, kVoxel).detection.found, 0U);
}

TEST(Score, reports_bias_and_rms_per_axis) {
  const std::vector<TruthRow> truth{real(0, 0, 0), real(1, 0, 0)};
  const auto d = score({{row(0, 0, 0.05, -0.03, 0.1), row(1, 0, -0.01, -0.03, 0.3)}, false}, truth, kVoxel).detection;
  EXPECT_NEAR(d.position_mm.mean[0], 0.02, 1e-15);
  EXPECT_NEAR(d.position_mm.mean_absolute[0], 0.03, 1e-15);
  EXPECT_NEAR(d.position_mm.rms[0], std::sqrt((0.0025 + 0.0001) / 2), 1e-15);
  EXPECT_NEAR(d.position_mm.mean[1], -0.03, 1e-15);
  EXPECT_NEAR(d.position_mm.mean[2], 0.2, 1e-15);
}

TEST(Score, counts_frames_without_any_detection_as_missed) {
  const std::vector<TruthRow> truth{real(0, 0, 0), real(1, 0, 0), real(2, 0, 0), real(9, 0, 0)};
  const auto d = score({{row(0, 0, 0), row(2, 0, 0)}, false}, truth, kVoxel).detection;
  EXPECT_EQ(d.truth, 3U);  // frame 9 is beyond the measurement
  EXPECT_EQ(d.found, 2U);
  EXPECT_EQ(d.frames, 3U);
}

TEST(Score, of_nothing_measured_is_zero_recall) {
  const auto d = score({{}, false}, {real(0, 0, 0), real(7, 0, 0)}, kVoxel).detection;
  EXPECT_EQ(d.truth, 2U);
  EXPECT_EQ(d.recall, 0.0);
  EXPECT_EQ(d.ghosts, 0U);
}

TEST(Score, refuses_the_truth_of_another_recording) {
  EXPECT_THROW(score({{row(500, 0, 0)}, false}, {real(0, 0, 0)}, kVoxel), Error);
}

TEST(Score, tells_whole_tracks_from_fragments_and_switches) {
  std::vector<TruthRow> truth;
  Measurement measured{{}, true};
  for (std::uint64_t f = 0; f < 10; ++f) {
    truth.push_back(real(f, 0, 0));
    truth.push_back(real(f, 1, 1));
    measured.rows.push_back(row(f, 50, 0));               // whole
    measured.rows.push_back(row(f, f < 6 ? 60 : 61, 1));  // broken once
  }
  const auto t = score(measured, truth, kVoxel).track;
  EXPECT_EQ(t.trajectories, 2U);
  EXPECT_EQ(t.trajectories_found, 2U);
  EXPECT_EQ(t.tracks, 3U);
  EXPECT_DOUBLE_EQ(t.purity, 1.0);
  EXPECT_DOUBLE_EQ(t.fragmentation, 1.5);
  EXPECT_EQ(t.id_switches, 1U);
  EXPECT_DOUBLE_EQ(t.coverage, (1.0 + 0.6) / 2);
}

TEST(Score, sees_two_tracks_that_swapped_particles) {
  std::vector<TruthRow> truth;
  Measurement measured{{}, true};
  for (std::uint64_t f = 0; f < 10; ++f) {
    truth.push_back(real(f, 0, 0));
    truth.push_back(real(f, 1, 1));
    measured.rows.push_back(row(f, f < 5 ? 7 : 8, 0));
    measured.rows.push_back(row(f, f < 5 ? 8 : 7, 1));
  }
  const auto t = score(measured, truth, kVoxel).track;
  EXPECT_DOUBLE_EQ(t.purity, 0.5);
  EXPECT_EQ(t.id_switches, 2U);
}

TEST(Score, cuts_trajectories_where_the_particle_leaves_the_view) {
  std::vector<TruthRow> truth;
  Measurement measured{{}, true};
  for (std::uint64_t f = 0; f < 9; ++f) {
    truth.push_back(real(f, 0, 0, 0, 0, f < 3 || f > 5));
    if (f < 3 || f > 5) measured.rows.push_back(row(f, f < 3 ? 1 : 2, 0));
  }
  const auto t = score(measured, truth, kVoxel).track;
  EXPECT_EQ(t.trajectories, 2U);
  EXPECT_DOUBLE_EQ(t.fragmentation, 1.0);
  EXPECT_EQ(t.id_switches, 0U);
}

TEST(Score, names_tracks_that_never_met_a_particle_ghosts) {
  const auto t = score({{row(0, 1, 0), row(0, 2, 5)}, true}, {real(0, 0, 0)}, kVoxel).track;
  EXPECT_EQ(t.ghost_tracks, 1U);
}

TEST(Score, compares_velocities_from_the_second_point_of_a_track_on) {
  TruthRow truth = real(1, 0, 0);
  truth.vx_mm_s = 10;
  TrackRow second = row(1, 0, 0);
  second.vx_mm_s = 11;
  second.age = 1;
  EXPECT_DOUBLE_EQ(score({{second}, true}, {truth}, kVoxel).track.velocity_mm_s.mean[0], 1.0);
  second.age = 0;
  EXPECT_DOUBLE_EQ(score({{second}, true}, {truth}, kVoxel).track.velocity_mm_s.mean[0], 0.0);
}

TEST(Truth, reads_columns_of_both_names) {
  const auto rows = parse_truth(
      "frame,t_s,id,X_mm,Y_mm,Z_mm,VX_mm_s,VY_mm_s,VZ_mm_s,Xi_mm,footprint_fully_in_fov\n"
      "3,0.006,17,1.5,-2,0.25,1,2,3,9,0\n",
      "other.csv");
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].particle, 17U);
  EXPECT_EQ(rows[0].z_mm, 0.25);
  EXPECT_EQ(rows[0].vy_mm_s, 2);
  EXPECT_EQ(rows[0].t_s, 0.006);
  EXPECT_FALSE(rows[0].in_view);
}

TEST(Measurement, is_points_without_and_tracks_with_identities) {
  EXPECT_FALSE(parse_measurement("frame,x,y,z,residual,support\n0,1,2,3,0.1,40\n", "points.csv").linked);
  EXPECT_TRUE(parse_measurement("frame,particle,x,y,z\n0,5,1,2,3\n", "tracks.csv").linked);
}

/// A random case: true particles on a line, measured near them or not, some tracks.
struct Case {
  std::vector<TruthRow> truth;
  Measurement measured;
};

Case arbitrary_case() {
  Case c;
  c.measured.linked = true;
  const auto coordinate = rc::gen::map(rc::gen::inRange(0, 60), [](int v) { return 0.05 * v; });
  for (std::uint64_t frame = 0; frame < 4; ++frame) {
    const int truths = *rc::gen::inRange(1, 8), found = *rc::gen::inRange(0, 8);
    for (int i = 0; i < truths; ++i)
      c.truth.push_back(real(frame, static_cast<std::uint64_t>(i), *coordinate, 0, 0, *rc::gen::inRange(0, 4) > 0));
    for (int i = 0; i < found; ++i)
      c.measured.rows.push_back(row(frame, static_cast<std::uint64_t>(*rc::gen::inRange(0, 6)), *coordinate));
  }
  return c;
}

TEST(Score, keeps_its_books_for_any_case) {
  EXPECT_TRUE(rc::check("sums and shares", [] {
    const Case c = arbitrary_case();
    RC_PRE(!c.measured.rows.empty());
    const auto result = score(c.measured, c.truth, kVoxel);
    const auto& d = result.detection;
    RC_ASSERT(d.found + d.partly_visible + d.ghosts == d.measured);
    RC_ASSERT(d.found <= d.truth);
    RC_ASSERT(d.measured == c.measured.rows.size());
    RC_ASSERT(d.recall >= 0 && d.recall <= 1 && d.precision >= 0 && d.precision <= 1);
    const auto& t = result.track;
    RC_ASSERT(t.purity >= 0 && t.purity <= 1 && t.coverage >= 0 && t.coverage <= 1);
    RC_ASSERT(t.trajectories_found == 0 || t.fragmentation >= 1);
    RC_ASSERT(t.ghost_tracks <= t.tracks && t.trajectories_found <= t.trajectories);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      RC_ASSERT(d.position_mm.rms[axis] <= kVoxel.radius_mm[axis] + 1e-12);
      RC_ASSERT(std::abs(d.position_mm.mean[axis]) <= d.position_mm.mean_absolute[axis] + 1e-12);
      RC_ASSERT(d.position_mm.mean_absolute[axis] <= d.position_mm.rms[axis] + 1e-12);
    }
  }));
}

TEST(Score, does_not_depend_on_the_order_of_rows) {
  EXPECT_TRUE(rc::check("any order", [] {
    const Case c = arbitrary_case();
    RC_PRE(!c.measured.rows.empty());
    Case reversed = c;
    std::reverse(reversed.truth.begin(), reversed.truth.end());
    const auto a = score(c.measured, c.truth, kVoxel).detection,
               b = score(reversed.measured, reversed.truth, kVoxel).detection;
    RC_ASSERT(a.truth == b.truth);
    RC_ASSERT(a.measured == b.measured);
  }));
}

TEST(Score, of_the_truth_itself_is_perfect) {
  EXPECT_TRUE(rc::check("perfect", [] {
    Case c = arbitrary_case();
    c.measured.rows.assign(c.truth.begin(), c.truth.end());
    const auto d = score(c.measured, c.truth, {{0.01, 0.01, 0.01}}).detection;
    RC_ASSERT(d.recall == 1.0 || d.truth == 0);
    RC_ASSERT(d.ghosts == 0);
    RC_ASSERT(d.rms_mm == 0);
  }));
}

TEST(ScoreReport, says_the_figures_in_text_and_json) {
  const ScoreSettings settings = kVoxel;
  const auto result = score({{row(0, 1, 0.05), row(0, 2, 9)}, true}, {real(0, 0, 0), real(0, 1, 1)}, settings);
  EXPECT_NE(to_text(result, settings).find("50.00 % (1 found of 2 in view, 1 frames)"), std::string::npos);
  EXPECT_NE(to_json(result).find("\"recall\":0.5"), std::string::npos);
  EXPECT_NE(to_json(result).find("\"fragmentation\":1"), std::string::npos);
}

}  // namespace
}  // namespace rptv
