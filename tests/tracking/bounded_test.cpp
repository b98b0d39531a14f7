// SPDX-License-Identifier: MIT
// Hostile input ends, in bounded memory, with an answer: crowds, equal places, overload, and no allocation.
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <set>

#include "tests/tracking/linking.hpp"

namespace rptv {
namespace {

constexpr std::size_t kCrowd = 10'000;

LinkerSettings crowd_settings() {
  LinkerSettings settings = settings_for(1.0, 1);
  settings.max_particles = settings.max_tracks = kCrowd;
  return settings;
}

TEST(Bounded, links_a_crowd_at_one_place_completely) {
  Session session(crowd_settings());
  const Positions3 crowd(kCrowd, Position{1, 1, 1});
  session.next(crowd);
  session.next(crowd);
  EXPECT_EQ(session.linker.counters().links, kCrowd);
  EXPECT_EQ(session.linker.counters().truncated_searches, kCrowd);
}

TEST(Bounded, ends_tracks_of_a_crowd_that_halves) {
  Session session(crowd_settings());
  session.next(Positions3(kCrowd, Position{1, 1, 1}));
  session.next(Positions3(kCrowd / 2, Position{1, 1, 1}));
  EXPECT_EQ(session.tracks.size(), kCrowd / 2);
  EXPECT_GT(session.linker.counters().links, kCrowd / 4);
}

TEST(Bounded, answers_with_ten_thousand_particles_within_one_search_range) {
  Session session(crowd_settings());
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> place(0, 0.5);
  for (int frame = 0; frame < 3; ++frame) {
    Positions3 crowd(kCrowd);
    for (Position& p : crowd) p = {place(random), place(random), place(random)};
    const auto ids = session.next(crowd);
    EXPECT_EQ(std::set<std::uint64_t>(ids.begin(), ids.end()).size(), kCrowd);
  }
  EXPECT_GT(session.linker.counters().links, kCrowd);
}

TEST(Bounded, refuses_and_counts_particles_beyond_its_capacity) {
  LinkerSettings settings = settings_for(1.0);
  settings.max_particles = settings.max_tracks = 10;
  Session session(settings);
  Positions3 many(25);
  for (std::size_t i = 0; i < many.size(); ++i) many[i] = {5.0 * static_cast<double>(i), 0, 0};
  EXPECT_EQ(session.next(many).size(), 10U);
  EXPECT_EQ(session.linker.counters().refused_particles, 15U);
}

TEST(Bounded, forgets_the_longest_unseen_tracks_first_when_full) {
  LinkerSettings settings = settings_for(1.0, 100);
  settings.max_particles = settings.max_tracks = 2;
  Session session(settings);
  session.next({{0, 0, 0}});
  session.next({{10, 0, 0}});
  EXPECT_EQ(session.next({{20, 0, 0}}), std::vector<std::uint64_t>{2});
  EXPECT_EQ(session.tracks.deaths, std::vector<std::uint64_t>{0});
  EXPECT_EQ(session.linker.counters().forgotten_tracks, 1U);
  EXPECT_EQ(session.next({{10, 0, 0}}), std::vector<std::uint64_t>{1});
}

TEST(Bounded, uses_the_nearest_particles_when_there_are_more_than_it_may_consider) {
  LinkerSettings settings = settings_for(10.0);
  settings.max_candidates = 2;
  Session session(settings);
  session.next({{0, 0, 0}});
  const auto ids = session.next({{3, 0, 0}, {0.1, 0, 0}, {2, 0, 0}, {1, 0, 0}});
  EXPECT_EQ(ids[1], 0U);
  EXPECT_EQ(session.linker.counters().truncated_searches, 1U);
}

TEST(Bounded, survives_positions_and_velocities_without_measure) {
  LinkerSettings settings = settings_for(1e9, 3, "velocity");
  Session session(settings);
  constexpr double kMost = std::numeric_limits<double>::max();
  session.next({{kMost, -kMost, kMost}, {0, 0, 0}, {-kMost, 5e-324, -5e-324}}, 0, 0);
  session.next({{1e9, 0, 0}, {kMost, -kMost, kMost}, {kMost / 2, 0, 0}}, 1, 1);
  session.next({{1e9, 0, 0}, {kMost, -kMost, kMost}}, 2, INT64_MAX);
  session.next({}, 3, INT64_MIN);
  const auto ids = session.next({{1e9, 0, 0}, {kMost, -kMost, kMost}}, 4, 5);
  EXPECT_EQ(ids.size(), 2U);
}

}  // namespace
}  // namespace rptv
