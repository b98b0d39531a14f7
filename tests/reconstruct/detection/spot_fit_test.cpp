// SPDX-License-Identifier: MIT
// The arithmetic of sixteen spots at once: squares against plain copies, functions against the library's, exact
// Gaussians.
#include "reconstruct/detection/spot_fit.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <random>

#include "reconstruct/detection/lanes.hpp"
#include "reconstruct/detection/spot_square.hpp"
#include "reconstruct/detection/square_lanes.hpp"
#include "tests/core/instruction_sets.hpp"
#include "tests/reconstruct/random_image.hpp"

namespace rptv {
namespace {

TEST(Lanes, know_logarithms_and_exponentials) {
  using Lanes = LaneTypes<4>::Lanes;
  for (double x = -60; x < 60; x += 0.0371) {
    const double e = static_cast<double>(exp_of(Lanes{} + static_cast<float>(x))[3]);
    ASSERT_NEAR(e / std::exp(static_cast<double>(static_cast<float>(x))), 1, 3e-7) << x;
    const auto argument = static_cast<float>(std::exp(x));
    const double expected = std::log(static_cast<double>(argument));
    ASSERT_NEAR(static_cast<double>(log_of(Lanes{} + argument)[2]), expected,
                1.2e-7 * std::max(std::abs(expected), 1.0));
  }
}

template <class Pixel>
void expect_plain_squares(const testing::RandomImage& image, const DarkPixels& dark, std::int32_t radius) {
  const GreyOverBackground<Pixel> grey(image.view(), dark, 200);
  for (std::int32_t y = 0; y < grey.height(); ++y)
    for (std::int32_t x = 0; x < grey.width(); ++x) {
      if (!has_whole_rows(grey, {x, y}, radius)) continue;
      for (const auto set : testing::sets_here()) {
        SpotBatch::Square square{};
        const SquareCounts counts = copy_square(grey, {x, y}, radius, square, set);
        std::size_t lit = 0, saturated = 0;
        for (std::int32_t dy = -radius; dy <= radius; ++dy)
          for (std::int32_t dx = -radius; dx <= radius; ++dx) {
            const auto k = static_cast<std::size_t>((dy + radius) * 8 + dx + radius);
            const std::size_t i = grey.index(x + dx, y + dy);
            RC_ASSERT(square[k] == static_cast<float>(image.at(x + dx, y + dy)) - dark.mean[i]);
            lit += square[k] > grey.dark(grey.index(x, y)), saturated += image.at(x + dx, y + dy) >= 200;
          }
        RC_ASSERT(counts.lit == lit);
        RC_ASSERT(counts.saturated == saturated);
      }
    }
}

RC_GTEST_PROP(SpotSquare, is_a_plain_copy_with_every_instruction_set, ()) {
  const auto image = testing::any_image(24);
  DarkPixels dark{std::vector<float>(image.shape.pixels(), 7), DarkLimit(image.shape, 7, 30)};
  if (*rc::gen::arbitrary<bool>()) {
    for (std::size_t i = 0; i < dark.mean.size(); ++i) dark.mean[i] = static_cast<float>(i % 17) * 0.3F;
    dark.limit.follow(dark.mean, dark.mean, {}, 20, 3);
  }
  const auto radius = *rc::gen::inRange(1, 4);
  if (image.shape.bytes_per_pixel == 1)
    expect_plain_squares<std::uint8_t>(image, dark, radius);
  else
    expect_plain_squares<std::uint16_t>(image, dark, radius);
}

// Gaussians as they are at the middles of pixels, without noise.
SpotBatch exact_batch(std::int32_t radius, double sigma) {
  SpotBatch batch{};
  for (std::size_t i = 0; i < SpotBatch::kSpots; ++i)
    for (std::int32_t dy = -radius; dy <= radius; ++dy)
      for (std::int32_t dx = -radius; dx <= radius; ++dx) {
        const double x = dx - 0.03 * static_cast<double>(i), y = dy + 0.4 - 0.05 * static_cast<double>(i);
        const auto k = static_cast<std::size_t>((dy + radius) * 8 + dx + radius);
        batch.grey[i][k] = static_cast<float>(180 * std::exp(-(x * x + y * y) / (2 * sigma * sigma)));
        batch.usable[i][k] = 1;
      }
  return batch;
}

TEST(SpotFit, is_exact_for_an_exact_gaussian) {
  for (const auto method : {SpotMethod::gaussian, SpotMethod::three_point})
    for (const std::int32_t radius : {1, 2, 3})
      for (const double sigma : {0.8, 1.2, 1.9})
        for (const auto set : testing::sets_here()) {
          SpotOptions options;
          options.method = method, options.radius = static_cast<std::size_t>(radius);
          SpotCentres centres{};
          find_spot_centres(exact_batch(radius, sigma), options, centres, set);
          for (std::size_t i = 0; i < SpotBatch::kSpots; ++i) {
            EXPECT_NEAR(static_cast<double>(centres.x[i]), 0.03 * static_cast<double>(i), 2e-4);
            EXPECT_NEAR(static_cast<double>(centres.y[i]), -0.4 + 0.05 * static_cast<double>(i), 2e-4);
            EXPECT_GT(centres.variance[i], 0);
            if (method != SpotMethod::gaussian) continue;
            EXPECT_NEAR(static_cast<double>(centres.peak[i]), 180, 0.1);
            EXPECT_NEAR(static_cast<double>(centres.bend[i]), -0.5 / (sigma * sigma), 1e-3);
            EXPECT_LT(centres.misfit[i], 1e-3);
          }
        }
}

SpotBatch random_batch(std::uint32_t seed) {
  std::mt19937 random(seed);
  SpotBatch batch{};
  for (auto& square : batch.grey)
    for (float& grey : square) grey = static_cast<float>(random() % 200);
  for (auto& square : batch.usable) square.fill(1);
  return batch;
}

template <std::size_t kLanes>
void expect_turned(const SpotBatch& batch, std::size_t rows) {
  typename SquareLanes<kLanes>::Turned turned;
  SquareLanes<kLanes>::turn(batch.grey.data(), rows, turned);
  for (std::size_t k = 0; k < rows * SpotBatch::kRow; ++k)
    for (std::size_t i = 0; i < kLanes; ++i) RC_ASSERT(turned[k][i] == batch.grey[i][k]);
}

RC_GTEST_PROP(SpotFit, turns_squares_as_a_plain_loop_does, (std::uint32_t seed)) {
  const SpotBatch batch = random_batch(seed);
  const std::size_t rows = *rc::gen::element<std::size_t>(3, 5, 7);
  expect_turned<4>(batch, rows), expect_turned<8>(batch, rows), expect_turned<16>(batch, rows);
}

RC_GTEST_PROP(SpotFit, gives_the_same_bits_with_and_without_the_hint_and_with_every_instruction_set,
              (std::uint32_t seed)) {
  SpotBatch batch = random_batch(seed);
  SpotOptions options;
  options.method = *rc::gen::element(SpotMethod::gaussian, SpotMethod::three_point, SpotMethod::centroid);
  options.radius = *rc::gen::inRange<std::size_t>(1, 4);
  SpotCentres plain{}, centres{};
  find_spot_centres(batch, options, plain, InstructionSet::portable);
  for (const bool all_usable : {false, true})
    for (const auto set : testing::sets_here()) {
      batch.all_usable.fill(all_usable);
      find_spot_centres(batch, options, centres, set);
      RC_ASSERT(centres.x == plain.x && centres.y == plain.y && centres.variance == plain.variance);
      RC_ASSERT(centres.grey == plain.grey && centres.peak == plain.peak && centres.bend == plain.bend);
    }
}

TEST(SpotFit, leaves_out_what_is_not_usable) {
  SpotBatch batch = exact_batch(2, 1.2);
  for (std::size_t i = 0; i < SpotBatch::kSpots; ++i)
    for (const std::size_t k : {18U, 19U, 26U})
      batch.grey[i][k] = 255, batch.usable[i][k] = 0;  // the middle and two beside it
  SpotCentres centres{};
  find_spot_centres(batch, {}, centres);
  for (std::size_t i = 0; i < SpotBatch::kSpots; ++i) {
    EXPECT_NEAR(static_cast<double>(centres.x[i]), 0.03 * static_cast<double>(i), 1e-3);
    EXPECT_NEAR(static_cast<double>(centres.peak[i]), 180, 1);
  }
}

}  // namespace
}  // namespace rptv
