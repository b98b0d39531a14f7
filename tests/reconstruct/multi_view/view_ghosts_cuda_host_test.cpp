// SPDX-License-Identifier: MIT
// The device's rounds against the CPU's plain way through the ranking.
#include "reconstruct/multi_view/view_ghosts_cuda.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <random>

#include "reconstruct/multi_view/view_ghosts.hpp"
#include "tests/reconstruct/on_device.hpp"

namespace rptv {
namespace {

using testing::OnDevice;

constexpr std::uint32_t kViews = 5, kMostDetections = 64;

std::vector<ViewMatch> random_matches(std::mt19937& random, std::size_t count, std::uint32_t detections, int levels) {
  std::vector<ViewMatch> matches;
  for (std::size_t i = 0; i < count; ++i) {
    ViewMatch match{ViewTuple::none(), {}, 0, 0};
    while (match.tuple.views < 2)
      for (std::size_t v = 0; v < kViews; ++v)
        match.tuple.put(v, random() % 4 == 0 ? kUnseen : static_cast<std::uint32_t>(random() % detections));
    match.s = levels > 0 ? static_cast<double>(random() % static_cast<unsigned>(levels))
                         : std::uniform_real_distribution<double>(0, 2)(random);
    matches.push_back(match);
  }
  return matches;
}

std::vector<std::uint32_t> columns_of(const std::vector<ViewMatch>& matches, std::size_t capacity) {
  std::vector<std::uint32_t> detection(kViews * capacity);
  for (std::size_t v = 0; v < kViews; ++v)
    for (std::size_t i = 0; i < std::min(capacity, matches.size()); ++i)
      detection[v * capacity + i] = matches[i].tuple.detection[v];
  return detection;
}

/// What is known of one frame's choice on the device.
struct Choice {
  explicit Choice(const std::vector<ViewMatch>& matches, std::size_t most = 1000)
      : capacity(static_cast<std::uint32_t>(std::min(matches.size(), most))),
        detection(columns_of(matches, capacity)),
        count({static_cast<std::uint32_t>(matches.size())}),
        s(of(matches)),
        chosen(std::vector<std::uint32_t>(matches.size(), 0)),
        used(std::vector<std::uint32_t>(kViews * kMostDetections, 0)),
        owner(std::vector<std::uint32_t>(kViews * kMostDetections, 99)) {}

  static std::vector<double> of(const std::vector<ViewMatch>& matches) {
    std::vector<double> values;
    for (const ViewMatch& match : matches) values.push_back(match.s);
    return values;
  }
  std::vector<std::uint32_t> run(CudaRank rank, unsigned threads) {
    EXPECT_TRUE(choose_by_rank_cuda({detection.data(), count.data(), capacity, kViews},
                                    {s.data(), chosen.data(), used.data(), owner.data(), kMostDetections}, rank,
                                    stream.handle(), threads));
    const auto flags = chosen.read(stream);
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < flags.size(); ++i)
      if (flags[i] != 0) numbers.push_back(i);
    return numbers;
  }

  std::uint32_t capacity;
  OnDevice<std::uint32_t> detection, count;
  OnDevice<double> s;
  OnDevice<std::uint32_t> chosen, used, owner;
  CudaStream stream;
};

/// The definition: in order of rank, whoever finds all its detections free.
std::vector<std::uint32_t> in_order(const std::vector<ViewMatch>& matches) {
  std::vector<std::uint32_t> order(matches.size()), chosen;
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](auto a, auto b) {
    return std::tuple(kViews - matches[a].tuple.views, matches[a].s, matches[a].tuple.detection, a) <
           std::tuple(kViews - matches[b].tuple.views, matches[b].s, matches[b].tuple.detection, b);
  });
  std::vector<std::uint8_t> used(kViews * kMostDetections);
  for (const std::uint32_t i : order) {
    bool free = true;
    for (std::size_t v = 0; v < kViews; ++v) {
      const std::uint32_t d = matches[i].tuple.detection[v];
      free = free && (d == kUnseen || used[v * kMostDetections + d] == 0);
    }
    if (!free) continue;
    for (std::size_t v = 0; v < kViews; ++v)
      if (const std::uint32_t d = matches[i].tuple.detection[v]; d != kUnseen) used[v * kMostDetections + d] = 1;
    chosen.push_back(i);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

std::vector<std::uint32_t> of_the_cpu(const std::vector<ViewMatch>& matches, bool most_views_first) {
  ViewGhosts ranks(kViews, kMostDetections, 200, {1, true, most_views_first});
  const auto by_rank = ranks.choose(matches);
  std::vector<std::uint32_t> chosen(by_rank.begin(), by_rank.end());
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

RC_GTEST_PROP(ViewGhostsCuda, choose_what_the_seeds_ranking_does, ()) {
  std::mt19937 random(*rc::gen::inRange(0U, 1U << 30));
  const auto matches = random_matches(random, *rc::gen::inRange<std::size_t>(0, 150), *rc::gen::inRange(1U, 60U), 0);
  cuda_host::set_schedule_seed(*rc::gen::inRange(0U, 9U));
  RC_ASSERT(Choice(matches).run(CudaRank::by_s, *rc::gen::element(32U, 96U, 256U)) == of_the_cpu(matches, false));
}

RC_GTEST_PROP(ViewGhosts, choose_by_views_then_s_what_a_plain_loop_does, ()) {
  std::mt19937 random(*rc::gen::inRange(0U, 1U << 30));
  const auto matches = random_matches(random, *rc::gen::inRange<std::size_t>(0, 150), *rc::gen::inRange(1U, 60U), 0);
  RC_ASSERT(of_the_cpu(matches, true) == in_order(matches));
}

RC_GTEST_PROP(ViewGhostsCuda, choose_by_views_then_s_then_detections_what_a_plain_loop_does, ()) {
  std::mt19937 random(*rc::gen::inRange(0U, 1U << 30));
  const auto matches = random_matches(random, *rc::gen::inRange<std::size_t>(0, 150), *rc::gen::inRange(1U, 60U),
                                      *rc::gen::inRange(0, 4));
  cuda_host::set_schedule_seed(*rc::gen::inRange(0U, 9U));
  RC_ASSERT(Choice(matches).run(CudaRank::by_views_then_s, *rc::gen::element(32U, 96U, 256U)) == in_order(matches));
}

TEST(ViewGhostsCuda, take_more_tuples_than_a_block_has_threads_with_every_schedule) {
  std::mt19937 random(3);
  const auto matches = random_matches(random, 777, 50, 3);
  testing::with_every_schedule(
      [&](unsigned threads) { EXPECT_EQ(Choice(matches).run(CudaRank::by_views_then_s, threads), in_order(matches)); });
}

TEST(ViewGhostsCuda, end_where_tuples_are_equal_or_have_no_s) {
  std::mt19937 random(4);
  auto matches = random_matches(random, 1, 4, 1);
  matches.resize(70, matches[0]);
  auto nothing = matches;
  for (ViewMatch& match : nothing) match.s = std::nan("");
  testing::with_every_schedule([&](unsigned threads) {
    EXPECT_EQ(Choice(matches).run(CudaRank::by_s, threads), std::vector<std::uint32_t>{0});
    EXPECT_EQ(Choice(nothing).run(CudaRank::by_s, threads), std::vector<std::uint32_t>{});
  });
}

TEST(ViewGhostsCuda, keep_what_an_earlier_call_took) {
  std::mt19937 random(5);
  const auto matches = random_matches(random, 90, 20, 0);
  Choice choice(matches);
  const auto first = choice.run(CudaRank::by_views_then_s, 96);
  EXPECT_EQ(choice.run(CudaRank::by_views_then_s, 32), first);
}

TEST(ViewGhostsCuda, leave_out_what_had_no_room) {
  std::mt19937 random(6);
  const auto matches = random_matches(random, 100, 20, 0);
  EXPECT_EQ(Choice(matches, 40).run(CudaRank::by_views_then_s, 32), in_order({matches.begin(), matches.begin() + 40}));
}

}  // namespace
}  // namespace rptv
