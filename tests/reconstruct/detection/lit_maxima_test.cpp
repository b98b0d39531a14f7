// SPDX-License-Identifier: MIT
// The scan for bright maxima, and the search for near ones, against plain loops, with every instruction set.
#include "reconstruct/detection/lit_maxima.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <set>

#include "reconstruct/detection/near_pairs.hpp"
#include "tests/core/instruction_sets.hpp"
#include "tests/reconstruct/random_image.hpp"

namespace rptv {
namespace {

using testing::any_limit;
using testing::RandomImage;

std::vector<PixelIndex> plain_maxima(const RandomImage& image, const DarkLimit& limit) {
  std::vector<PixelIndex> maxima;
  const auto width = static_cast<std::int32_t>(image.shape.width_px);
  for (std::int32_t y = 1; y + 1 < static_cast<std::int32_t>(image.shape.height_px); ++y)
    for (std::int32_t x = 1; x + 1 < width; ++x) {
      const auto grey = image.at(x, y);
      bool is_maximum = grey > limit.limits()[static_cast<std::size_t>(y * width + x)];
      for (std::int32_t dy = -1; dy <= 1; ++dy)
        for (std::int32_t dx = -1; dx <= 1; ++dx) {
          const bool before = dy < 0 || (dy == 0 && dx < 0), itself = dy == 0 && dx == 0;
          const auto neighbour = image.at(x + dx, y + dy);
          if (before ? neighbour >= grey : !itself && neighbour > grey) is_maximum = false;
        }
      if (is_maximum) maxima.push_back({x, y});
    }
  return maxima;
}

RC_GTEST_PROP(LitMaxima, are_those_of_a_plain_loop_with_every_instruction_set, ()) {
  const RandomImage image = testing::any_image(*rc::gen::element(8U, 70U, 200U));
  const DarkLimit limit = any_limit(image);
  const auto expected = plain_maxima(image, limit);
  for (const auto set : testing::sets_here()) {
    std::vector<PixelIndex> maxima(image.shape.pixels());
    maxima.resize(find_lit_maxima(image.view(), limit, maxima, set));
    RC_ASSERT(maxima == expected);
  }
}

RC_GTEST_PROP(LitMaxima, beyond_the_room_are_counted, ()) {
  const RandomImage image = testing::any_image(150);
  const DarkLimit limit(image.shape, 0, 0);
  const auto expected = plain_maxima(image, limit);
  for (const auto set : testing::sets_here()) {
    std::vector<PixelIndex> maxima(expected.size() / 2);
    RC_ASSERT(find_lit_maxima(image.view(), limit, maxima, set) == expected.size());
    RC_ASSERT(std::equal(maxima.begin(), maxima.end(), expected.begin()));
  }
}

// Few pixels in some rows and many in others, so that both ways to look for them are gone.
RC_GTEST_PROP(NearPairs, are_those_of_a_plain_double_loop, ()) {
  const auto reach = *rc::gen::inRange(0, kMostReach + 1);
  std::mt19937 random(*rc::gen::inRange(0U, 1U << 30));
  std::vector<PixelIndex> sorted;
  for (std::int32_t y = 0; y < 24; ++y)
    for (std::int32_t x = 0; x < 96; ++x)
      if (random() % (y / 6 % 2 == 0 ? 2 : 50) == 0) sorted.push_back({x, y});
  std::set<std::pair<std::size_t, std::size_t>> expected, pairs;
  for (std::size_t j = 0; j < sorted.size(); ++j)
    for (std::size_t i = 0; i < j; ++i)
      if (sorted[j].y - sorted[i].y <= reach && std::abs(sorted[j].x - sorted[i].x) <= reach) expected.insert({i, j});
  for (const auto set : testing::sets_here()) {
    std::size_t visits = 0;
    pairs.clear();
    each_near_pair(sorted, reach, near_columns(set), [&](std::size_t i, std::size_t j) {
      pairs.insert({i, j}), ++visits;
    });
    RC_ASSERT(pairs == expected);
    RC_ASSERT(visits == expected.size());
  }
}

}  // namespace
}  // namespace rptv
