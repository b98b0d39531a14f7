// SPDX-License-Identifier: MIT
// The grid finds exactly the points within the radius, however they are spread.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tracking/cell_grid.hpp"

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
  CellGrid grid(cloud.x.size() + 3);
  grid.build(cloud.x.data(), cloud.y.data(), cloud.z.data(), cloud.x.size(), radius);
  for (std::size_t q = 0; q < cloud.x.size(); ++q) {
    if (!std::isfinite(cloud.x[q] + cloud.y[q] + cloud.z[q])) continue;
    const double qx = cloud.x[q] + 0.4 * radius;
    const double qz = cloud.z[q] - 0.6 * radius;
    std::vector<Near> near(cloud.x.size());
    near.resize(grid.find_near(qx, cloud.y[q], qz, q, near.data(), near.size()));
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
  grid.build(cloud.x.data(), cloud.y.data(), cloud.z.data(), 50, 1.0);
  EXPECT_EQ(grid.size(), 48U);
  EXPECT_EQ(grid.place(7), CellGrid::kNone);
  EXPECT_EQ(grid.place(49), CellGrid::kNone);
  expect_the_same(cloud, 1.0);
}

TEST(CellGrid, answers_queries_from_outside_and_from_nowhere) {
  const Cloud cloud = uniform(100, 2, 1);
  CellGrid grid(100);
  grid.build(cloud.x.data(), cloud.y.data(), cloud.z.data(), 100, 0.5);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const double q : {50.0, -50.0, 1e300, -1e300, kNan, kInf, -kInf}) {
    Near found;
    EXPECT_EQ(grid.find_near(q, 0, 0, 0, &found, 1), 0U);
  }
}

TEST(CellGrid, begins_elsewhere_for_every_query_at_a_crowded_point) {
  Cloud cloud;
  for (int i = 0; i < 1000; ++i) cloud.add(1, 2, 3);
  CellGrid grid(1000);
  grid.build(cloud.x.data(), cloud.y.data(), cloud.z.data(), 1000, 0.5);
  for (std::size_t q = 0; q < 1000; q += 37) {
    Near first;
    EXPECT_EQ(grid.find_near(1, 2, 3, q, &first, 1), 1U);
    EXPECT_EQ(first.place, q);
  }
}

}  // namespace
}  // namespace rptv
