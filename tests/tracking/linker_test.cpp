// SPDX-License-Identifier: MIT
// Which particle is which: motion, gaps, memory, prediction, births, deaths and identities.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "core/error.hpp"
#include "tests/tracking/linking.hpp"
#include "tests/tracking/moving_points.hpp"

namespace rptv {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Ids = std::vector<std::uint64_t>;

TEST(Linker, follows_one_stepper) {
  Session session(settings_for(1.0));
  for (int i = 0; i < 20; ++i) EXPECT_EQ(session.next({{0.9 * i, 5, 0}}), Ids{0});
  EXPECT_EQ(session.tracks.age_frames, std::vector<std::uint32_t>{19});
}

TEST(Linker, follows_two_steppers_whatever_their_order) {
  Session session(settings_for(1.0));
  EXPECT_THAT(session.next({{0, 0, 0}, {0, 10, 0}}), ElementsAre(0, 1));
  EXPECT_THAT(session.next({{0.5, 10, 0}, {0.5, 0, 0}}), ElementsAre(1, 0));
  EXPECT_THAT(session.next({{1.0, 0, 0}, {1.0, 10, 0}}), ElementsAre(0, 1));
}

TEST(Linker, links_a_step_of_exactly_the_search_range_and_none_beyond) {
  Session session(settings_for(0.5));
  session.next({{1, 1, 0}, {4, 1, 0}});
  EXPECT_THAT(session.next({{1.5, 1, 0}, {4.5000001, 1, 0}}), ElementsAre(0, 2));
  EXPECT_THAT(session.tracks.deaths, ElementsAre(1));
}

TEST(Linker, gives_up_the_nearest_pair_when_the_sum_is_smaller) {
  Session session(settings_for(1.0));
  session.next({{0, 0, 0}, {0.6, 0, 0}});
  // Nearest first would join 0.6 to 0.5 and leave 0 without: 0.01 + 1. Both one to the right: 0.25 + 0.36.
  EXPECT_THAT(session.next({{0.5, 0, 0}, {1.2, 0, 0}}), ElementsAre(0, 1));
}

TEST(Linker, leaves_a_track_unlinked_where_that_costs_less) {
  Session session(settings_for(1.0));
  session.next({{0, 0, 0}, {0.9, 0, 0}});
  // To link both would cost 0.81 + 0.9025; one link and one end cost 0.0025 + 1.
  EXPECT_THAT(session.next({{0.9, 0, 0}, {1.85, 0, 0}}), ElementsAre(1, 2));
}

TEST(Linker, solves_the_contracting_grid_as_one_subnetwork) {
  Positions3 grid;
  for (int i = -15; i < 15; ++i)
    for (int j = -15; j < 15; ++j) grid.push_back({0.1 * i, 0.1 * j, 0});
  Positions3 contracted = grid;
  for (Position& p : contracted) p = {0.97 * p[0], 0.97 * p[1], 0};
  Session session(settings_for(0.25));
  const auto before = session.next(grid);
  EXPECT_EQ(session.next(contracted), before);
  EXPECT_GE(session.linker.counters().largest_subnet, 800U);
}

TEST(Linker, takes_the_same_subnetwork_in_three_dimensions_and_in_the_plane) {
  Session flat(settings_for(1.0));
  Session tilted(settings_for(1.0));
  flat.next({{0, 0, 0}, {0.6, 0, 0}, {1.3, 0, 0}});
  tilted.next({{0, 0, 0}, {0, 0, 0.6}, {0, 0, 1.3}});
  EXPECT_EQ(flat.next({{0.4, 0, 0}, {1.1, 0, 0}, {1.9, 0, 0}}), tilted.next({{0, 0, 0.4}, {0, 0, 1.1}, {0, 0, 1.9}}));
}

TEST(Linker, finds_a_particle_again_within_its_memory) {
  Session session(settings_for(0.5, 2));
  session.next({{0, 0, 0}});
  for (int gap = 0; gap < 2; ++gap) {
    EXPECT_THAT(session.next({}), IsEmpty());
    EXPECT_THAT(session.tracks.deaths, IsEmpty());
    EXPECT_EQ(session.linker.live_tracks(), 1U);
  }
  EXPECT_THAT(session.next({{0.2, 0, 0}}), ElementsAre(0));
  EXPECT_EQ(session.tracks.age_frames[0], 1U);
}

TEST(Linker, reports_a_death_in_the_frame_that_exhausts_the_memory) {
  Session session(settings_for(0.5, 2));
  session.next({{0, 0, 0}});
  session.next({});
  session.next({});
  EXPECT_THAT(session.tracks.deaths, IsEmpty());
  EXPECT_THAT(session.next({}), IsEmpty());
  EXPECT_THAT(session.tracks.deaths, ElementsAre(0));
  EXPECT_EQ(session.linker.live_tracks(), 0U);
  EXPECT_THAT(session.next({{0, 0, 0}}), ElementsAre(1));
}

TEST(Linker, counts_lost_frame_indices_against_the_memory) {
  Session session(settings_for(0.5, 2));
  session.next({{0, 0, 0}}, 10);
  EXPECT_THAT(session.next({{0, 0, 0}}, 13), ElementsAre(0)) << "frames 11 and 12 are within the memory of 2";
  EXPECT_THAT(session.next({{0, 0, 0}}, 17), ElementsAre(1)) << "frames 14, 15 and 16 are not";
  EXPECT_THAT(session.tracks.deaths, ElementsAre(0));
}

TEST(Linker, never_gives_an_identity_twice) {
  Session session(settings_for(0.4, 1));
  std::set<std::uint64_t> alive, dead;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place(0, 3);
  for (int i = 0; i < 300; ++i) {
    Positions3 positions(random() % 12);
    for (Position& p : positions) p = {place(random), place(random), place(random)};
    const auto ids = session.next(positions);
    for (const std::uint64_t id : session.tracks.births) EXPECT_TRUE(alive.insert(id).second && dead.count(id) == 0);
    for (const std::uint64_t id : ids) EXPECT_EQ(alive.count(id), 1U);
    for (const std::uint64_t id : session.tracks.deaths) EXPECT_TRUE(alive.erase(id) == 1 && dead.insert(id).second);
    EXPECT_EQ(session.linker.live_tracks(), alive.size());
  }
  EXPECT_GT(dead.size(), 100U);
  EXPECT_EQ(session.linker.counters().deaths, dead.size());
}

TEST(Linker, keeps_rows_in_the_order_of_the_particles) {
  MovingPoints points(500, MovingPoints::Steps::walk, 0.3, 3);
  Particles particles(500);
  Session session(settings_for(0.4));
  for (std::uint64_t frame = 0; frame < 5; ++frame) {
    points.next(particles);
    for (std::size_t i = 0; i < particles.size(); ++i) particles.residual_mm[i] = static_cast<double>(i);
    session.linker.next(particles, frame, static_cast<std::int64_t>(frame) * kPeriodNs, session.tracks);
    EXPECT_EQ(session.tracks.x_mm, particles.x_mm);
    EXPECT_EQ(session.tracks.z_mm, particles.z_mm);
    EXPECT_EQ(session.tracks.residual_mm, particles.residual_mm);
  }
}

TEST(Linker, exchanges_crossing_particles_without_prediction_and_keeps_them_with_it) {
  for (const bool predict : {false, true}) {
    Session session(settings_for(0.7, 0, predict ? "velocity" : "none"));
    for (int i = 0; i < 3; ++i) session.next({{0.3 * i, 0.05, 0}, {1.5 - 0.3 * i, -0.05, 0}});
    // They pass each other between frames 2 and 3: at 0.6 and 0.9, then at 0.9 and 0.6.
    EXPECT_EQ(session.next({{0.9, 0.05, 0}, {0.6, -0.05, 0}}), (predict ? Ids{0, 1} : Ids{1, 0}));
  }
}

TEST(Linker, predicts_by_time_across_lost_frames) {
  Session session(settings_for(0.2, 5, "velocity"));
  session.next({{0, 0, 0}}, 0);
  session.next({{0.15, 0, 0}}, 1);
  EXPECT_THAT(session.next({{0.90, 0, 0}}, 6), ElementsAre(0)) << "five steps of 0.15 mm in five periods";
  EXPECT_NEAR(session.tracks.vx_mm_s[0], 15, 1e-9);
}

TEST(Linker, keeps_two_particles_at_one_place_apart) {
  Session session(settings_for(0.5));
  session.next({{1, 1, 1}, {1, 1, 1}});
  const auto ids = session.next({{1, 1, 1}, {1, 1, 1}});
  EXPECT_EQ(std::set<std::uint64_t>(ids.begin(), ids.end()), (std::set<std::uint64_t>{0, 1}));
}

TEST(Linker, leaves_out_particles_that_are_not_finite) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Session session(settings_for(0.5));
  EXPECT_THAT(session.next({{kNan, 0, 0}, {1, 1, 1}, {0, kInf, 0}, {0, 0, -kInf}}), ElementsAre(0));
  EXPECT_THAT(session.next({{1.1, 1, 1}, {kNan, kNan, kNan}}), ElementsAre(0));
  EXPECT_EQ(session.linker.counters().ignored_particles, 4U);
  EXPECT_THAT(session.next({{kNan, 0, 0}}), IsEmpty());
}

TEST(Linker, refuses_settings_that_make_no_sense) {
  for (const double range : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(Linker{settings_for(range)}, Error);
  EXPECT_THROW(Linker{settings_for(1, -1)}, Error);
  EXPECT_THROW(Linker{settings_for(1, 0, "crystal ball")}, Error);
}

TEST(Linker, gives_the_same_tracks_for_the_same_input) {
  std::vector<Ids> runs[2];
  for (auto& run : runs) {
    MovingPoints points(800, MovingPoints::Steps::gauss, 0.5, 11);
    Particles particles(800);
    Session session(settings_for(1.0, 2, "velocity"));
    for (std::uint64_t frame = 0; frame < 10; ++frame) {
      points.next(particles);
      session.linker.next(particles, frame, static_cast<std::int64_t>(frame) * kPeriodNs, session.tracks);
      run.push_back(session.tracks.particle);
    }
  }
  EXPECT_EQ(runs[0], runs[1]);
}

TEST(Linker, recovers_almost_every_link_of_a_short_walk) {
  MovingPoints points(1000, MovingPoints::Steps::walk, 0.1, 5);
  Particles particles(1000);
  Session session(settings_for(0.105));
  std::vector<std::uint64_t> id_of(1000), last_id_of;
  std::size_t right = 0;
  for (std::uint64_t frame = 0; frame < 20; ++frame) {
    points.next(particles);
    session.linker.next(particles, frame, static_cast<std::int64_t>(frame) * kPeriodNs, session.tracks);
    last_id_of = id_of;
    for (std::size_t i = 0; i < 1000; ++i) id_of[points.truth()[i]] = session.tracks.particle[i];
    for (std::size_t i = 0; i < 1000 && frame > 0; ++i) right += id_of[i] == last_id_of[i] ? 1 : 0;
  }
  EXPECT_GT(static_cast<double>(right) / 19'000, 0.995);
}

}  // namespace
}  // namespace rptv
