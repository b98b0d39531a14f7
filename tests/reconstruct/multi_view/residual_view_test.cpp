// SPDX-License-Identifier: MIT
// Residual images and the sums over spots against plain double precision over the whole image.
#include "reconstruct/multi_view/residual_view.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstring>
#include <random>

#include "tests/core/instruction_sets.hpp"
#include "tests/reconstruct/multi_view/plain_spot.hpp"

namespace rptv {
namespace {

constexpr int kWidth = 53, kHeight = 41;
constexpr ImageShape kShape{kWidth, kHeight, 2};
constexpr GreyNoise kNoise{4, 0.5F};

double between(double from, double to) { return from + (to - from) * 1e-6 * *rc::gen::inRange(0, 1000000); }

ViewSpot any_spot() {
  return {static_cast<float>(between(-6, kWidth + 5)), static_cast<float>(between(-6, kHeight + 5)),
          static_cast<float>(between(0.3, 3.4)), static_cast<float>(between(50, 2000))};
}

/// Grey values 100 to 1099 over a background of 100, one in twenty saturated at 1050.
struct AnyImage {
  std::vector<std::uint16_t> pixels;
  DarkPixels dark = make_dark({100, 10, ""}, kShape, {});

  AnyImage() {
    std::mt19937 random(*rc::gen::arbitrary<unsigned>());
    std::uniform_int_distribution<std::uint16_t> grey_value(100, 1099);
    for (std::size_t i = 0; i < kShape.pixels(); ++i) pixels.push_back(grey_value(random));
  }
  ImageView view() const { return {reinterpret_cast<const std::byte*>(pixels.data()), kShape}; }
  double grey(int x, int y) const { return pixels[static_cast<std::size_t>(y * kWidth + x)] - 100.0; }
  double weight(int x, int y) const { return grey(x, y) >= 950 ? 0 : 1 / (4 + 0.5 * grey(x, y)); }
};

RC_GTEST_PROP(ResidualView, is_the_image_less_all_spots, ()) {
  const AnyImage image;
  std::vector<ViewSpot> spots;
  const int count = *rc::gen::inRange(0, 30);
  for (int i = 0; i < count; ++i) spots.push_back(any_spot());
  std::vector<double> model(std::size_t{kWidth} * kHeight);
  testing::add_plain_spots(spots, kWidth, kHeight, model);
  double light = 0;
  for (const ViewSpot& spot : spots) light += static_cast<double>(spot.grey);
  std::vector<float> first;
  for (const auto set : testing::sets_here()) {
    ResidualView view(kShape, kNoise, 1050, set);
    view.load(image.view(), image.dark);
    view.subtract(spots);
    std::vector<float> all;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const double expected = image.grey(x, y) - model[static_cast<std::size_t>(y * kWidth + x)];
        all.push_back(view.residual_row(y)[x]);
        RC_ASSERT(std::abs(static_cast<double>(all.back()) - expected) < 2e-3 + 1e-3 * light);
        RC_ASSERT(std::abs(static_cast<double>(view.weight_row(y)[x]) - image.weight(x, y)) < 1e-6);
      }
    if (first.empty()) first = all;
    RC_ASSERT(std::memcmp(first.data(), all.data(), first.size() * sizeof first[0]) == 0);
    view.restore();
    RC_ASSERT(static_cast<double>(view.residual_row(7)[9]) == image.grey(9, 7));
  }
}

RC_GTEST_PROP(ResidualView, sums_are_those_of_the_whole_image, ()) {
  const AnyImage image;
  const ViewSpot spot = any_spot();
  const auto u = static_cast<double>(spot.u_px), v = static_cast<double>(spot.v_px);
  const auto sigma = static_cast<double>(spot.sigma_px);
  double mm = 0, uv = 0, uu = 0, mr = 0, ur = 0, vr = 0, most = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double across = testing::plain_share(x, u, sigma), down = testing::plain_share(y, v, sigma);
      const double by_u = testing::plain_slope(x, u, sigma) * down, by_v = across * testing::plain_slope(y, v, sigma);
      const double w = image.weight(x, y), r = image.grey(x, y), m = across * down;
      mm += w * m * m, uv += w * by_u * by_v, uu += w * by_u * by_u;
      mr += w * m * r, ur += w * by_u * r, vr += w * by_v * r;
      most += w * (m + std::abs(by_u) + std::abs(by_v)) * r;
    }
  SpotSums first{};
  for (const auto set : testing::sets_here()) {
    ResidualView view(kShape, kNoise, 1050, set);
    view.load(image.view(), image.dark);
    const SpotSums sums = view.sums(spot);
    RC_ASSERT(std::abs(static_cast<double>(sums.mm) - mm) <= 0.01 * mm + 1e-6);
    RC_ASSERT(std::abs(static_cast<double>(sums.uu) - uu) <= 0.05 * uu + 1e-6);
    RC_ASSERT(std::abs(static_cast<double>(sums.uv) - uv) <= 0.05 * uu + 1e-6);
    RC_ASSERT(std::abs(static_cast<double>(sums.mr) - mr) <= 0.02 * most + 2e-3);
    RC_ASSERT(std::abs(static_cast<double>(sums.ur) - ur) <= 0.02 * most + 2e-3);
    RC_ASSERT(std::abs(static_cast<double>(sums.vr) - vr) <= 0.02 * most + 2e-3);
    if (set == testing::sets_here().front()) first = sums;
    RC_ASSERT(std::memcmp(&first, &sums, sizeof sums) == 0);
  }
}

TEST(ResidualView, counts_no_pixel_of_an_image_that_is_missing) {
  ResidualView view(kShape, kNoise, 0);
  view.load_nothing();
  const SpotSums sums = view.sums({20, 20, 1, 100});
  EXPECT_EQ(sums.mm, 0);
  EXPECT_EQ(sums.mr, 0);
}

TEST(ResidualView, knows_which_spots_are_out_of_reach) {
  const ResidualView view(kShape, kNoise, 0);
  EXPECT_TRUE(view.near({-2, 10, 1, 1}));
  EXPECT_FALSE(view.near({-200, 10, 1, 1}));
  EXPECT_FALSE(view.near({10, std::nanf(""), 1, 1}));
}

}  // namespace
}  // namespace rptv
