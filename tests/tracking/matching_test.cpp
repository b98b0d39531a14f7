// SPDX-License-Identifier: MIT
// Ranges per axis, adaptive search and deadlines: what is linked, and what is said about it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <random>
#include <set>

#include "tests/tracking/linking.hpp"

namespace rptv {
namespace {

using testing::ElementsAre;

Positions3 crowd(std::size_t count, double side, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(0, side);
  Positions3 positions(count);
  for (Position& p : positions) p = {place(random), place(random), place(random)};
  return positions;
}

TEST(Matching, searches_as_far_along_each_axis_as_it_is_told) {
  LinkerSettings settings = settings_for(1);
  settings.search_range_xyz_mm = {0.1, 0, 3};
  Session session(settings);
  session.next({{0, 0, 0}, {0, 20, 0}, {0, 40, 0}});
  EXPECT_THAT(session.next({{0.2, 0, 0}, {0, 20.9, 0}, {0, 40, 2.9}}), ElementsAre(3, 1, 2));
}

RC_GTEST_PROP(Matching, links_by_axes_as_it_does_in_scaled_space, ()) {
  const auto count = *rc::gen::inRange<std::size_t>(1, 40);
  const auto seed = *rc::gen::arbitrary<unsigned>();
  const std::array<double, 3> range{0.5, 2, 4};  // powers of two: scaling is exact
  const Positions3 before = crowd(count, 2, seed);
  const Positions3 after = crowd(count, 2, seed + 1);
  LinkerSettings by_axes = settings_for(1);
  by_axes.search_range_xyz_mm = {range[0], range[1], range[2]};
  Session scaled(settings_for(1));
  Session session(by_axes);
  const auto stretched = [&](Positions3 positions) {
    for (Position& p : positions)
      for (std::size_t axis = 0; axis < 3; ++axis) p[axis] *= range[axis];
    return positions;
  };
  scaled.next(before);
  session.next(stretched(before));
  RC_ASSERT(session.next(stretched(after)) == scaled.next(after));
}

TEST(Matching, takes_an_oversize_subnetwork_apart_by_adaptive_search) {
  LinkerSettings settings = settings_for(2);
  settings.adaptive_stop_mm = 0.2;
  settings.adaptive_step = 0.5;
  settings.max_subnet = 2;
  Session session(settings);
  session.next({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}});
  EXPECT_THAT(session.next({{0.1, 0, 0}, {1.1, 0, 0}, {2.1, 0, 0}, {3.1, 0, 0}}), ElementsAre(0, 1, 2, 3));
  EXPECT_GT(session.linker.counters().adapted_subnets, 0U);
  EXPECT_EQ(session.linker.counters().cut_subnets, 0U);
  EXPECT_GT(session.tracks.adapted_subnets, 0U);
}

TEST(Matching, approximates_what_is_still_oversize_at_the_smallest_range) {
  LinkerSettings settings = settings_for(2);
  settings.adaptive_stop_mm = 1.5;
  settings.adaptive_step = 0.9;
  settings.max_subnet = 3;
  Session session(settings);
  session.next(crowd(50, 2, 1));
  const auto ids = session.next(crowd(50, 2, 2));
  EXPECT_GT(session.tracks.cut_subnets, 0U);
  EXPECT_EQ(session.linker.counters().cut_subnets, session.tracks.cut_subnets);
  EXPECT_EQ(std::set<std::uint64_t>(ids.begin(), ids.end()).size(), ids.size());
  EXPECT_GT(session.linker.counters().links, 40U);
}

TEST(Matching, answers_when_the_deadline_has_passed_and_says_so) {
  for (const double stop_mm : {0.0, 0.05}) {
    LinkerSettings settings = settings_for(1);
    settings.max_particles = settings.max_tracks = 5000;
    settings.deadline_ms = 1e-6;  // over before it begins
    settings.adaptive_stop_mm = stop_mm;
    Session session(settings);
    session.next(crowd(5000, 5, 1));
    const auto ids = session.next(crowd(5000, 5, 2));
    EXPECT_EQ(std::set<std::uint64_t>(ids.begin(), ids.end()).size(), 5000U);
    EXPECT_GT(session.tracks.cut_subnets + session.tracks.adapted_subnets, 0U);
    EXPECT_GT(session.linker.counters().links, stop_mm == 0 ? 4000U : 1000U);
  }
}

TEST(Matching, does_not_look_at_the_clock_where_little_is_to_do) {
  LinkerSettings settings = settings_for(1);
  settings.deadline_ms = 1e-6;
  Session hasty(settings);
  Session calm(settings_for(1));
  for (unsigned frame = 0; frame < 5; ++frame) {
    const Positions3 positions = crowd(200, 6, frame);
    EXPECT_EQ(hasty.next(positions), calm.next(positions));
  }
  EXPECT_EQ(hasty.linker.counters().cut_subnets, 0U);
}

}  // namespace
}  // namespace rptv
