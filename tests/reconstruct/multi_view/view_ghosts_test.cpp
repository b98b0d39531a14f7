// SPDX-License-Identifier: MIT
// The choice among rival sets against an oracle that tries all choices.
#include "reconstruct/multi_view/view_ghosts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace rptv {
namespace {

constexpr GhostOptions kOptions{1, false};

ViewMatch random_match(std::mt19937& random, std::uint32_t detections) {
  ViewMatch match{ViewTuple::none(), {}, 0, 0};
  while (match.tuple.views < 3)
    for (std::size_t v = 0; v < 4; ++v)
      match.tuple.put(v, random() % 4 == 0 ? kUnseen : static_cast<std::uint32_t>(random() % detections));
  match.square_px2 = std::uniform_real_distribution<double>(0, match.tuple.views)(random);
  match.s = std::sqrt(match.square_px2);
  return match;
}

std::vector<ViewMatch> random_matches(std::mt19937& random, std::size_t count, std::uint32_t detections) {
  std::vector<ViewMatch> matches;
  for (std::size_t i = 0; i < count; ++i) matches.push_back(random_match(random, detections));
  return matches;
}

double weight(const ViewMatch& match) { return 2.0 * match.tuple.views - 3 - match.square_px2; }

bool share(const ViewMatch& a, const ViewMatch& b) {
  for (std::size_t v = 0; v < 4; ++v)
    if (a.tuple.detection[v] != kUnseen && a.tuple.detection[v] == b.tuple.detection[v]) return true;
  return false;
}

double best_weight(const std::vector<ViewMatch>& matches, std::size_t first, std::vector<std::size_t>& taken) {
  if (first == matches.size()) return 0;
  double best = best_weight(matches, first + 1, taken);
  if (std::none_of(taken.begin(), taken.end(), [&](std::size_t t) { return share(matches[t], matches[first]); })) {
    taken.push_back(first);
    best = std::max(best, weight(matches[first]) + best_weight(matches, first + 1, taken));
    taken.pop_back();
  }
  return best;
}

double chosen_weight(const std::vector<ViewMatch>& matches, std::span<const std::uint32_t> chosen) {
  double sum = 0;
  for (const std::uint32_t m : chosen) {
    sum += weight(matches[m]);
    for (const std::uint32_t other : chosen) EXPECT_TRUE(other == m || !share(matches[m], matches[other]));
  }
  return sum;
}

TEST(ViewGhosts, chooses_what_weighs_most_of_all_choices) {
  std::mt19937 random(1);
  int better_than_greedy = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const auto matches = random_matches(random, 12, 3 + trial % 8);
    ViewGhosts ghosts(4, 16, 64, kOptions), ranks(4, 16, 64, {1, true});
    std::vector<std::size_t> taken;
    const double best = best_weight(matches, 0, taken), sum = chosen_weight(matches, ghosts.choose(matches));
    EXPECT_NEAR(sum, best, 1e-9);
    EXPECT_NEAR(ghosts.counts().weight, sum, 1e-9);
    EXPECT_NEAR(ghosts.counts().most_weight, best, 1e-9);
    EXPECT_EQ(ghosts.counts().unproven, 0U);
    better_than_greedy += chosen_weight(matches, ranks.choose(matches)) < best - 1e-9 ? 1 : 0;
  }
  EXPECT_GT(better_than_greedy, 20);
}

TEST(ViewGhosts, by_rank_takes_the_smallest_s_first) {
  std::mt19937 random(2);
  const auto matches = random_matches(random, 40, 8);
  ViewGhosts ranks(4, 16, 64, {1, true});
  const auto chosen = ranks.choose(matches);
  chosen_weight(matches, chosen);
  const auto least = std::min_element(matches.begin(), matches.end(), [](auto& a, auto& b) { return a.s < b.s; });
  ASSERT_FALSE(chosen.empty());
  EXPECT_EQ(chosen.front(), static_cast<std::uint32_t>(least - matches.begin()));
  EXPECT_TRUE(
      std::is_sorted(chosen.begin(), chosen.end(), [&](auto a, auto b) { return matches[a].s < matches[b].s; }));
}

TEST(ViewGhosts, gives_up_the_proof_for_a_huge_group_but_not_the_bound) {
  std::mt19937 random(3);
  const auto matches = random_matches(random, 5000, 200);
  ViewGhosts ghosts(4, 256, 5000, kOptions);
  const double sum = chosen_weight(matches, ghosts.choose(matches));
  EXPECT_GE(ghosts.counts().unproven, 1U);
  EXPECT_GE(sum, ghosts.counts().most_weight / 4);
  EXPECT_LE(sum, ghosts.counts().most_weight);
}

TEST(ViewGhosts, a_used_detection_stays_used_until_the_next_frame) {
  std::mt19937 random(4);
  const auto matches = random_matches(random, 1, 4);
  ViewGhosts ghosts(4, 16, 64, kOptions);
  EXPECT_EQ(ghosts.choose(matches).size(), 1U);
  EXPECT_EQ(ghosts.choose(matches).size(), 0U);
  ghosts.clear();
  EXPECT_EQ(ghosts.choose(matches).size(), 1U);
}

}  // namespace
}  // namespace rptv
