// SPDX-License-Identifier: MIT
// LatencyHistogram against a sorted vector.
#include "core/latency.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

namespace rptv {
namespace {

// Nearest rank, as the histogram defines it.
std::int64_t exact_percentile(std::vector<std::int64_t> sorted, double fraction) {
  const auto rank = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

RC_GTEST_PROP(LatencyHistogram, is_right_within_a_thirtysecond_of_a_sorted_vector, ()) {
  const auto bits = *rc::gen::inRange(1, 63);
  auto durations = *rc::gen::nonEmpty(
      rc::gen::container<std::vector<std::int64_t>>(rc::gen::inRange<std::int64_t>(0, std::int64_t{1} << bits)));
  const auto histogram = std::make_unique<LatencyHistogram>();
  for (const std::int64_t duration : durations) histogram->record(duration);
  std::sort(durations.begin(), durations.end());
  for (const double fraction : {0.0, 0.01, 0.25, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const std::int64_t exact = exact_percentile(durations, fraction);
    const std::int64_t found = histogram->percentile_ns(fraction);
    RC_ASSERT(found >= exact);
    RC_ASSERT(found - exact <= exact / 32);
  }
  RC_ASSERT(histogram->max_ns() == durations.back());
  RC_ASSERT(histogram->percentile_ns(1.0) == durations.back());
  RC_ASSERT(histogram->count() == durations.size());
}

TEST(LatencyHistogram, is_zero_while_empty) {
  const LatencyHistogram histogram;
  EXPECT_EQ(histogram.percentile_ns(0.5), 0);
  EXPECT_EQ(histogram.max_ns(), 0);
}

TEST(LatencyHistogram, takes_the_lower_of_two_for_the_median) {
  LatencyHistogram histogram;
  histogram.record(1);
  histogram.record(30);
  EXPECT_EQ(histogram.percentile_ns(0.5), 1);
  EXPECT_EQ(histogram.percentile_ns(0.51), 30);
}

TEST(LatencyHistogram, takes_the_largest_and_the_negative_duration) {
  LatencyHistogram histogram;
  histogram.record(std::numeric_limits<std::int64_t>::max());
  histogram.record(-5);
  EXPECT_EQ(histogram.percentile_ns(0.5), 0);
  EXPECT_EQ(histogram.percentile_ns(1.0), std::numeric_limits<std::int64_t>::max());
}

}  // namespace
}  // namespace rptv
