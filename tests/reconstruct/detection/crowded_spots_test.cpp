// SPDX-License-Identifier: MIT
// Which spots see each other, and the light that they leave in each other's squares, against plain loops.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <random>

#include "reconstruct/detection/crowded_square.hpp"
#include "reconstruct/detection/model_image.hpp"
#include "reconstruct/detection/spot_neighbours.hpp"
#include "tests/core/instruction_sets.hpp"

namespace rptv {
namespace {

// Some are dark, some alone, and some have moved away from where their search began.
std::vector<FittedSpot> random_spots(std::uint32_t seed, std::size_t count, std::int32_t size_px) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0, size_px), move(-2, 2);
  std::uniform_real_distribution<float> peak(-20, 250), bend(-0.6F, -0.05F);
  std::vector<FittedSpot> spots(count);
  for (FittedSpot& spot : spots) {
    const double x = place(random), y = place(random);
    spot.start = {static_cast<std::int32_t>(std::lround(x)), static_cast<std::int32_t>(std::lround(y))};
    spot.x_px = spot.start.x + move(random), spot.y_px = spot.start.y + move(random);
    spot.peak = std::max(peak(random), 0.0F), spot.bend = bend(random);
    spot.modelled = random() % 4 != 0, spot.crowded = spot.modelled && random() % 3 != 0;
  }
  return spots;
}

RC_GTEST_PROP(SpotNeighbours, are_those_of_a_plain_double_loop, (std::uint32_t seed)) {
  const auto radius = *rc::gen::inRange(1, 4);
  const auto size_px = *rc::gen::element(60, 400);
  const auto spots = random_spots(seed, *rc::gen::inRange<std::size_t>(1, 150), size_px);
  for (const auto set : testing::sets_here()) {
    SpotNeighbours neighbours(spots.size(), spots.size(), set);
    if (!neighbours.find(spots, radius)) RC_DISCARD("no room");
    for (std::size_t i = 0; i < spots.size(); ++i) {
      std::vector<std::uint32_t> expected;
      for (std::uint32_t k = 0; k < spots.size(); ++k) {
        const double seen = radius + ModelImage::reach(spots[k]) + SpotNeighbours::kMove;
        const bool lit = spots[i].peak > 0 && spots[k].peak > 0 && spots[i].crowded && spots[k].modelled;
        if (lit && k != i && std::abs(spots[i].x_px - spots[k].x_px) <= seen &&
            std::abs(spots[i].y_px - spots[k].y_px) <= seen)
          expected.push_back(k);
      }
      std::vector<std::uint32_t> found(neighbours.of(i).begin(), neighbours.of(i).end());
      std::sort(found.begin(), found.end());
      RC_ASSERT(found == expected);
    }
  }
}

TEST(SpotNeighbours, say_so_when_there_is_no_room_for_all) {
  std::vector<FittedSpot> spots(200);
  for (FittedSpot& spot : spots) spot.peak = 100, spot.bend = -0.2F, spot.modelled = spot.crowded = true;
  EXPECT_FALSE(SpotNeighbours(spots.size(), 100, best_instruction_set()).find(spots, 2));
  EXPECT_TRUE(SpotNeighbours(spots.size(), 1000, best_instruction_set()).find(spots, 2));
}

RC_GTEST_PROP(CrowdedSquare, has_the_light_of_plain_gaussians, (std::uint32_t seed)) {
  const auto radius = *rc::gen::inRange(1, 4);
  const auto spots = random_spots(seed, *rc::gen::inRange<std::size_t>(1, 12), 12);
  std::vector<std::uint32_t> others;
  for (std::uint32_t k = 1; k < spots.size(); ++k) others.push_back(k);
  const GreyNoise noise{1.5F, 0.25F};
  const auto light = [&](std::size_t k, std::int32_t x, std::int32_t y) {
    const double dx = x - spots[k].x_px, dy = y - spots[k].y_px;
    return static_cast<double>(spots[k].peak) * std::exp(static_cast<double>(spots[k].bend) * (dx * dx + dy * dy));
  };
  CrowdedSquare plain{};
  light_crowded_square(spots, 0, others, radius, noise, plain, InstructionSet::portable);
  double sum = 0, variances = 0;
  const PixelIndex middle = spots[0].middle();
  for (std::int32_t dy = -radius; dy <= radius; ++dy)
    for (std::int32_t dx = -radius; dx <= radius; ++dx) {
      const auto k = static_cast<std::size_t>(dy + radius) * SpotBatch::kRow + static_cast<std::size_t>(dx + radius);
      double left = 0;
      for (const std::uint32_t other : others) left += light(other, middle.x + dx, middle.y + dy);
      const double alone = 1.5 + 0.25 * light(0, middle.x + dx, middle.y + dy), all = alone + 0.25 * left;
      RC_ASSERT(std::abs(static_cast<double>(plain.others[k]) - left) <= 2e-5 * (1 + left));
      RC_ASSERT(std::abs(static_cast<double>(plain.weight[k]) - alone / all) <= 1e-5);
      sum += left, variances += all;
    }
  RC_ASSERT(std::abs(static_cast<double>(plain.others_sum) - sum) <= 2e-5 * (1 + sum));
  RC_ASSERT(std::abs(static_cast<double>(plain.variance_sum) - variances) <= 2e-5 * (1 + variances));
  for (const auto set : testing::sets_here()) {
    CrowdedSquare square{};
    light_crowded_square(spots, 0, others, radius, noise, square, set);
    RC_ASSERT(square.others == plain.others && square.weight == plain.weight);
    RC_ASSERT(square.others_sum == plain.others_sum && square.variance_sum == plain.variance_sum);
  }
}

}  // namespace
}  // namespace rptv
