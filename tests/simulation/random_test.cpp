// SPDX-License-Identifier: MIT
// Moments of the noise, and independence of its streams.
#include "simulation/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rptv {
namespace {

TEST(Random, poisson_has_its_mean_its_variance_and_its_skew) {
  for (const double mean : {0.03, 0.7, 4.0, 11.9, 12.1, 35.0, 400.0, 20000.0}) {
    Random random(3, 1);
    constexpr int kDraws = 200000;
    double sum = 0, square = 0, cube = 0;
    for (int i = 0; i < kDraws; ++i) {
      const double d = random.poisson(mean) - mean;
      sum += d;
      square += d * d;
      cube += d * d * d;
    }
    const double sigma = std::sqrt(mean / kDraws);
    EXPECT_NEAR(sum / kDraws, 0, 5 * sigma) << mean;
    EXPECT_NEAR(square / kDraws / mean, 1, 5 * std::sqrt((2 + 1 / mean) / kDraws)) << mean;
    EXPECT_NEAR(cube / kDraws / std::pow(mean, 1.5), 1 / std::sqrt(mean), 0.06 + 0.04 / std::sqrt(mean)) << mean;
  }
}

TEST(Random, poisson_of_nothing_is_nothing) {
  Random random(1, 1);
  EXPECT_EQ(random.poisson(0), 0U);
  EXPECT_EQ(random.poisson(-1), 0U);
  EXPECT_EQ(random.poisson(std::nan("")), 0U);
}

TEST(Random, normal_table_is_normal) {
  const float* table = normal_table();
  double sum = 0, square = 0, fourth = 0;
  int within_one = 0;
  for (int i = 0; i < 65536; ++i) {
    const double v = static_cast<double>(table[i]);
    sum += v;
    square += v * v;
    fourth += v * v * v * v;
    within_one += std::abs(v) <= 1;
    EXPECT_GE(table[i], table[std::max(0, i - 1)]);
  }
  EXPECT_NEAR(sum, 0, 1e-3);
  EXPECT_NEAR(square / 65536, 1, 1e-5);
  EXPECT_NEAR(fourth / 65536, 3, 0.01);
  EXPECT_NEAR(within_one / 65536.0, 0.682689, 2e-4);
}

TEST(Random, streams_and_seeds_do_not_repeat_each_other) {
  Random a(1, 5), b(1, 6), c(2, 5), again(1, 5);
  int same = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto x = a.bits();
    EXPECT_EQ(x, again.bits());
    same += (x == b.bits()) + (x == c.bits());
  }
  EXPECT_EQ(same, 0);
}

}  // namespace
}  // namespace rptv
