// SPDX-License-Identifier: MIT
// A spot of true votes is found wherever it is, under wrong ones that outnumber it; chance alone is no spot.
#include "calibration/cameras/disparity_map.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <random>
#include <vector>

#include "calibration/cameras/disparity_maps.hpp"
#include "core/error.hpp"
#include "tests/calibration/cameras/sample_cameras.hpp"
#include "tests/core/allocation_counter.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;

/// Wrong votes: most have small disparities, as points that meet by chance have.
void add_chance(DisparityMap& map, int votes, std::mt19937& random) {
  std::normal_distribution<double> any(0, map.radius_px() / 2);
  for (int i = 0; i < votes; ++i) map.add({any(random), any(random)});
}

void add_spot(DisparityMap& map, const Pixel& at, double spread_px, int votes, std::mt19937& random) {
  std::normal_distribution<double> error(0, spread_px);
  for (int i = 0; i < votes; ++i) map.add({at[0] + error(random), at[1] + error(random)});
}

TEST(DisparityMap, finds_the_spot_to_its_own_standard_error) {
  std::mt19937 random(1);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<double> squares;
  for (int trial = 0; trial < 200; ++trial) {
    DisparityMap map(between(1, 8));
    const double reach = 0.55 * map.radius_px(), cell = map.cell_px();
    const Pixel at{between(-reach, reach), between(-reach, reach)};
    add_spot(map, at, between(0.3, 2) * cell, 400, random);
    add_chance(map, 8000, random);
    const auto peak = map.peak();
    ASSERT_TRUE(peak.has_value()) << trial;
    const double miss = std::hypot(peak->at_px[0] - at[0], peak->at_px[1] - at[1]);
    squares.push_back(std::pow(miss / peak->sigma_px, 2) / 2);
    EXPECT_LT(miss, 5 * peak->sigma_px + 0.1 * cell) << trial;
    EXPECT_LT(peak->sigma_px, cell) << trial;
    EXPECT_GT(peak->votes, 100) << trial;
    EXPECT_LT(peak->votes, 800) << trial;
  }
  std::sort(squares.begin(), squares.end());
  const double mean = std::accumulate(squares.begin(), squares.end(), 0.0) / 200;
  std::printf("squared errors by their variance: mean %.2f, median %.2f (0.69), 95 %% below %.2f (3.00)\n", mean,
              squares[100], squares[190]);
  EXPECT_LT(mean, 2) << "the standard error is stated too small";
  EXPECT_GT(mean, 0.5) << "the standard error is stated too large";
}

TEST(DisparityMap, places_votes_of_one_disparity_exactly) {
  EXPECT_TRUE(rc::check([] {
    DisparityMap map(3);
    const Pixel at{*real(-1.8, 1.8), *real(-1.8, 1.8)};
    for (int i = 0; i < 40; ++i) RC_ASSERT(map.add(at));
    const auto peak = map.peak();
    RC_ASSERT(peak.has_value());
    RC_ASSERT(std::abs(peak->at_px[0] - at[0]) < 0.01 * map.cell_px());
    RC_ASSERT(std::abs(peak->at_px[1] - at[1]) < 0.01 * map.cell_px());
    RC_ASSERT(std::abs(peak->votes - 40) < 1e-3);
  }));
}

TEST(DisparityMap, takes_chance_for_what_it_is) {
  std::mt19937 random(3);
  int spots = 0;
  for (int i = 0; i < 200; ++i) {
    DisparityMap map(5);
    EXPECT_FALSE(map.peak());
    add_chance(map, 50 * i, random);
    spots += map.peak() ? 1 : 0;
  }
  EXPECT_LE(spots, 2);
}

TEST(DisparityMap, counts_what_is_beyond_it_and_forgets) {
  DisparityMap map(2);
  EXPECT_TRUE(map.add({1.2, -1.6}));
  EXPECT_FALSE(map.add({2.001, 0}));
  EXPECT_FALSE(map.add({0, std::nan("")}));
  EXPECT_EQ(map.votes(), 1);
  EXPECT_EQ(map.outside(), 2);
  map.fade(0.5);
  EXPECT_EQ(map.votes(), 0.5);
  map.clear();
  EXPECT_EQ(map.outside(), 0);
  EXPECT_THROW(DisparityMap(0), Error);
}

TEST(DisparityMaps, keep_cameras_and_parts_apart_without_allocating) {
  const DisparityGrid grid{{-10, -10, 0}, {10, 10, 5}, {2, 2, 1}};
  DisparityMaps maps(grid, 2, 3);
  AllocationCounter allocations;
  for (int i = 0; i < 100; ++i) {
    maps.add(0, {-6, -5, 1}, {1, 0.5});
    maps.add(1, {6, 5, 4}, {-2, 1});
    maps.add(1, {6, 5, 6}, {-2, 1});
  }
  EXPECT_EQ(allocations.disarm(), 0U);
  ASSERT_TRUE(maps.peak(0, 0).has_value());
  EXPECT_NEAR(maps.peak(0, 0)->at_px[0], 1, 0.01);
  EXPECT_FALSE(maps.peak(1, 0));
  const CameraDisparity second = maps.summary(1);
  EXPECT_EQ(second.parts, 1U);
  EXPECT_NEAR(second.worst_px, std::hypot(2, 1), 0.01);
  EXPECT_NEAR(second.worst_at_mm[0], 6, 1e-9);
  EXPECT_EQ(maps.outside(), 100);
  EXPECT_EQ(maps.middle_mm(1), grid.centre_mm(1));
}

TEST(DisparityGrid, has_every_point_of_its_box_in_the_nearest_part) {
  EXPECT_TRUE(rc::check([] {
    const DisparityGrid grid{{-40, -30, -40}, {40, 30, 40}, {4, 3, 2}};
    const Point3 point = drawn_point();
    const auto part = grid.part_of(point);
    RC_ASSERT(part.has_value());
    for (std::size_t other = 0; other < grid.size(); ++other)
      RC_ASSERT(norm(point - grid.centre_mm(*part)) <= norm(point - grid.centre_mm(other)) + 1e-9);
  }));
  EXPECT_FALSE((DisparityGrid{{0, 0, 0}, {1, 1, 1}, {1, 1, 1}}.part_of({0.5, 0.5, 1.5})));
  EXPECT_THROW(DisparityMaps({{0, 0, 0}, {1, 0, 1}, {1, 1, 1}}, 2, 1), Error);
  EXPECT_THROW(DisparityMaps({{0, 0, 0}, {1, 1, 1}, {100, 100, 1}}, 2, 1), Error);
}

}  // namespace
}  // namespace rptv
