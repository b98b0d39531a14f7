// SPDX-License-Identifier: MIT
// The grid finds exactly the points within the radius, however they are spread.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tracking/cell_grid.hpp"
#include "tracking/near_mask.hpp"
#include "tracking/nearest.hpp"

namespace rptv {
namespace {

struct Cloud {
  std::vector<double> x, y, z;
  void add(double px, double py, double pz) {
    x.push_back(px);
    y.push_back(py);
    z.push_back(pz);
  }
};

/// Squared distances over radius², as the grid is to report them.
std::vector<std::uint32_t> near_by_trial(const Cloud& cloud, double qx, double qy, double qz, double radius) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < cloud.x.size(); ++i) {
    const double dx = (cloud.x[i] - qx) * (1 / radius);
    const double dy = (cloud.y[i] - qy) * (1 / radius);
    const double dz = (cloud.z[i] - qz) * (1 / radius);
    if (dx * dx + dy * dy + dz * dz <= 1) found.push_back(i);
  }
  return found;
}

void expect_the_same(const Cloud& cloud, double radius) {
  CellGrid grid(cloud.x.size());
  CellGrid plain(cloud.x.size(), InstructionSet::portable);
  for (CellGrid* built : {&grid, &plain})
    built->build(cloud.x.data(), cloud.y.data(), cloud.z.data(), cloud.x.size(), {radius, radius, radius});
  for (std::size_t q = 0; q < cloud.x.size(); ++q) {
    if (!std::isfinite(cloud.x[q] + cloud.y[q] + cloud.z[q])) continue;
    const double qx = cloud.x[q] + 0.4 * radius;
    const double qz = cloud.z[q] - 0.6 * radius;
    std::vector<Near> near(cloud.x.size() + CellGrid::kSlack);
    near.resize(grid.find_near(qx, cloud.y[q], qz, q, near.data(), cloud.x.size()));
    std::vector<Near> by_plain(cloud.x.size() + CellGrid::kSlack);
    by_plain.resize(plain.find_near(qx, cloud.y[q], qz, q, by_plain.data(), cloud.x.size()));
    ASSERT_TRUE(std::equal(near.begin(), near.end(), by_plain.begin(), by_plain.end(),
                           [](const Near& a, const Near& b) { return a.cost == b.cost && a.place == b.place; }))
        << "another instruction set finds otherwise";
    std::vector<std::uint32_t> found;
    for (const Near& n : near) {
      EXPECT_LE(n.cost, 1);
      EXPECT_EQ(grid.place(grid.original(n.place)), n.place);
      found.push_back(grid.original(n.place));
    }
    std::sort(found.begin(), found.end());
    ASSERT_EQ(found, near_by_trial(cloud, qx, cloud.y[q], qz, radius)) << "round point " << q;
  }
}

Cloud uniform(std::size_t count, double side, double depth) {
  Cloud cloud;
  std::mt19937_64 random(count);
  std::uniform_real_distribution<double> place(-side / 2, side / 2);
  for (std::size_t i = 0; i < count; ++i) cloud.add(place(random), place(random), depth * place(random));
  return cloud;
}

TEST(CellGrid, finds_all_points_of_a_uniform_cloud) {
  for (const double radius : {0.01, 0.3, 1.0, 3.0, 100.0}) expect_the_same(uniform(700, 9, 1), radius);
}

// Under the address sanitizer: a small grid must not choose more cells than it has room for.
TEST(CellGrid, finds_all_of_few_points_with_room_for_few) {
  for (const std::size_t count : {1U, 2U, 5U, 10U, 19U, 20U, 33U, 60U})
    for (const double radius : {0.02, 0.3, 1.4, 1.7, 2.2, 3.0}) expect_the_same(uniform(count, 9, 1), radius);
}

TEST(CellGrid, finds_all_points_in_a_plane_and_on_a_line) {
  expect_the_same(uniform(500, 20, 0), 1.0);
  Cloud line;
  for (int i = 0; i < 400; ++i) line.add(0, 0.1 * i, 7);
  expect_the_same(line, 0.55);
}

TEST(CellGrid, is_not_misled_by_outliers) {
  for (const double far : {1e3, 1e9, 1e200, 1.7e308}) {
    Cloud cloud = uniform(1000, 10, 1);
    cloud.add(far, 0, 0);
    cloud.add(-far, far, far);
    expect_the_same(cloud, 0.8);
  }
}

TEST(CellGrid, finds_all_points_of_far_clusters) {
  Cloud cloud;
  std::mt19937_64 random(1);
  std::normal_distribution<double> near(0, 0.3);
  for (int i = 0; i < 900; ++i) {
    const double centre = 1e4 * (i % 30);
    cloud.add(centre + near(random), -centre + near(random), near(random));
  }
  expect_the_same(cloud, 0.5);
}

TEST(CellGrid, finds_all_points_of_a_lattice_at_every_spacing) {
  for (const double spacing : {0.5, 1.0, 8.0, 64.0, 1024.0}) {
    Cloud cloud;
    for (int i = 0; i < 512; ++i) cloud.add(spacing * (i % 8), spacing * (i / 8 % 8), spacing * (i / 64));
    expect_the_same(cloud, 1.0);
  }
}

TEST(CellGrid, finds_all_points_however_large_and_small_the_numbers_are) {
  std::mt19937_64 random(17);
  const std::vector<double> sizes{0, 5e-324, 1e-9, 1, 1e9, 1e15, 3e16, 1e200, std::numeric_limits<double>::max() / 2};
  std::uniform_real_distribution<double> factor(-2, 2);
  for (int cloud_number = 0; cloud_number < 300; ++cloud_number) {
    Cloud cloud;
    const double common = sizes[random() % sizes.size()];
    const auto coordinate = [&] {
      return random() % 3 == 0 ? sizes[random() % sizes.size()] * factor(random) : common;
    };
    for (int i = 0; i < 40; ++i) cloud.add(coordinate(), coordinate(), coordinate());
    for (const double radius : {1e-9, 1.0, 1e9}) expect_the_same(cloud, radius);
  }
}

TEST(CellGrid, leaves_out_points_that_are_not_finite) {
  Cloud cloud = uniform(50, 3, 1);
  cloud.y[7] = std::numeric_limits<double>::quiet_NaN();
  cloud.z[49] = std::numeric_limits<double>::infinity();
  CellGrid grid(50);
  grid.build(cloud.x.data(), cloud.y.data(), cloud.z.data(), 50, {1, 1, 1});
  EXPECT_EQ(grid.size(), 48U);
  EXPECT_EQ(grid.place(7), CellGrid::kNone);
  EXPECT_EQ(grid.place(49), CellGrid::kNone);
  expect_the_same(cloud, 1.0);
}

TEST(CellGrid, answers_queries_from_outside_and_from_nowhere) {
  const Cloud cloud = uniform(100, 2, 1);
  CellGrid grid(100);
  grid.build(cloud.x.data(), cloud.y.data(), cloud.z.data(), 100, {0.5, 0.5, 0.5});
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const double q : {50.0, -50.0, 1e300, -1e300, kNan, kInf, -kInf}) {
    Near found[1 + CellGrid::kSlack];
    EXPECT_EQ(grid.find_near(q, 0, 0, 0, found, 1), 0U);
  }
}

TEST(CellGrid, begins_elsewhere_for_every_query_at_a_crowded_point) {
  Cloud cloud;
  for (int i = 0; i < 1000; ++i) cloud.add(1, 2, 3);
  CellGrid grid(1000);
  grid.build(cloud.x.data(), cloud.y.data(), cloud.z.data(), 1000, {0.5, 0.5, 0.5});
  for (std::size_t q = 0; q < 1000; q += 37) {
    Near first[1 + CellGrid::kSlack];
    EXPECT_EQ(grid.find_near(1, 2, 3, q, first, 1), 1U);
    EXPECT_EQ(first[0].place, q);
  }
}

TEST(CellGrid, finds_all_points_in_an_ellipsoid) {
  const Cloud cloud = uniform(700, 9, 2);
  CellGrid grid(700);
  for (const SearchRange& range : {SearchRange{0.3, 0.5, 2.5}, SearchRange{4, 0.2, 1}, SearchRange{1, 1, 1}}) {
    grid.build(cloud.x.data(), cloud.y.data(), cloud.z.data(), 700, range);
    for (std::size_t q = 0; q < 700; ++q) {
      std::vector<Near> near(700 + CellGrid::kSlack);
      near.resize(grid.find_near(cloud.x[q], cloud.y[q], cloud.z[q], q, near.data(), 700));
      std::size_t expected = 0;
      for (std::size_t i = 0; i < 700; ++i)
        expected += std::pow((cloud.x[i] - cloud.x[q]) * (1 / range[0]), 2) +
                        std::pow((cloud.y[i] - cloud.y[q]) * (1 / range[1]), 2) +
                        std::pow((cloud.z[i] - cloud.z[q]) * (1 / range[2]), 2) <=
                    1;
      ASSERT_EQ(near.size(), expected);
    }
  }
}

TEST(CellGrid, tests_four_points_at_once_as_one_by_one) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> place(-2, 2);
  for (int trial = 0; trial < 20'000; ++trial) {
    double x[4], y[4], z[4], cost[4], plain[4];
    for (std::size_t k = 0; k < 4; ++k) x[k] = place(random), y[k] = place(random), z[k] = place(random);
    const Ellipsoid e{place(random), place(random), place(random), 0.7, 0.9, 1.3};
    ASSERT_EQ(near_mask(x, y, z, e, cost), near_mask_plain(x, y, z, e, plain));
    for (std::size_t k = 0; k < 4; ++k) ASSERT_EQ(cost[k], plain[k]);
  }
}

TEST(CellGrid, finds_the_nearest_point_of_a_kind) {
  const Cloud cloud = uniform(500, 8, 1);
  CellGrid grid(500);
  grid.build(cloud.x.data(), cloud.y.data(), cloud.z.data(), 500, {0.4, 0.4, 0.4});
  const auto even = [&](std::uint32_t place) { return grid.original(place) % 2 == 0; };
  for (std::size_t q = 0; q < 500; ++q) {
    double least = 1e9;
    for (std::size_t i = 0; i < 500; i += 2)
      least = std::min(least, std::hypot(cloud.x[i] - cloud.x[q], cloud.y[i] - cloud.y[q], cloud.z[i] - cloud.z[q]));
    const std::uint32_t place = grid.find_nearest(cloud.x[q], cloud.y[q], cloud.z[q], even);
    ASSERT_NE(place, CellGrid::kNone);
    EXPECT_EQ(std::hypot(grid.x(place) - cloud.x[q], grid.y(place) - cloud.y[q], grid.z(place) - cloud.z[q]), least);
  }
  EXPECT_EQ(grid.find_nearest(0, 0, 0, [](std::uint32_t) { return false; }), CellGrid::kNone);
}

}  // namespace
}  // namespace rptv
