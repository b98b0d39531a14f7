// SPDX-License-Identifier: MIT
// Few sets that agree in all cameras are found among a hundred times as many that do not.
#include "reconstruct/multi_view/agreeing_sets.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <random>

namespace rptv {
namespace {

constexpr double kRadius_px = 5;

/// Disparities in a disc of each view, as of rays that meet by chance.
SetDisparities by_chance(std::size_t views, std::mt19937& random) {
  std::uniform_real_distribution<double> turn(0, 2 * M_PI), part(0, 1);
  SetDisparities set;
  for (std::size_t v = 0; v < views; ++v) {
    const double length = kRadius_px * std::sqrt(part(random)), angle = turn(random);
    set.views |= 1U << v;
    set.px[v] = {static_cast<float>(length * std::cos(angle)), static_cast<float>(length * std::sin(angle))};
  }
  return set;
}

/// `place` with an error of 0.15 px; every fifth lacks a view. Marked by its position.
SetDisparities like(const SetDisparities& place, std::size_t views, std::mt19937& random) {
  std::normal_distribution<double> error(0, 0.15);
  SetDisparities set = place;
  set.at_mm = {1, 0, 0};
  for (std::size_t v = 0; v < views; ++v)
    for (float& coordinate : set.px[v]) coordinate += static_cast<float>(error(random));
  if (random() % 5 == 0) set.views &= ~(1U << random() % views);
  return set;
}

TEST(AgreeingSets, are_found_among_a_hundred_times_as_many_by_chance) {
  EXPECT_TRUE(rc::check([] {
    std::mt19937 random(*rc::gen::arbitrary<unsigned>());
    const auto views = *rc::gen::inRange<std::size_t>(4, 7);
    const SetDisparities place = by_chance(views, random);
    std::vector<SetDisparities> sets;
    for (int i = 0; i < 4000; ++i) sets.push_back(by_chance(views, random));
    for (int i = 0; i < 60; ++i) sets.push_back(like(place, views, random));
    std::shuffle(sets.begin(), sets.end(), random);
    const auto found = agreeing_sets(sets, kRadius_px);
    int alike = 0;
    for (const SetDisparities& set : found) alike += set.at_mm[0] == 1 ? 1 : 0;
    RC_ASSERT(sets.size() == 4060U);
    RC_ASSERT(alike >= 55);
    RC_ASSERT(found.size() <= 85U);
  }));
}

TEST(AgreeingSets, of_chance_alone_are_none) {
  std::mt19937 random(2);
  for (const int count : {0, 1, 7, 300, 5000}) {
    std::vector<SetDisparities> sets;
    for (int i = 0; i < count; ++i) sets.push_back(by_chance(4, random));
    EXPECT_TRUE(agreeing_sets(sets, kRadius_px).empty()) << count;
  }
}

}  // namespace
}  // namespace rptv
