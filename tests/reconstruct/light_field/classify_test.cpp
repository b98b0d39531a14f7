// SPDX-License-Identifier: MIT
// Local maxima and DBSCAN against their definitions, written down naively.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>
#include <random>

#include "reconstruct/light_field/classify_dbscan.hpp"
#include "reconstruct/light_field/classify_local_maxima.hpp"

namespace rptv {
namespace {

VoxelGrid unit_grid(int x, int y, int planes) {
  VoxelGrid grid;
  grid.size_x = x, grid.size_y = y, grid.planes = planes;
  return grid;
}

// Parallel rays to (x, y) of a one-plane grid make any picture of counters.
RayCounter counter_of(const VoxelGrid& grid, int rays, unsigned seed, std::uint16_t least) {
  Rays all(static_cast<std::size_t>(rays), 1);
  std::mt19937 random(seed);
  std::normal_distribution<float> spread(0, 0.9F);
  std::uniform_real_distribution<float> x_of(0, static_cast<float>(grid.size_x)),
      y_of(0, static_cast<float>(grid.size_y));
  std::uniform_real_distribution<float> slope(-0.3F, 0.3F);
  float x = 0, y = 0;
  for (std::size_t i = 0; i < all.ray.size(); ++i) {
    if (i % 40 == 0) x = x_of(random), y = y_of(random);
    const float s = slope(random), t = slope(random), z = static_cast<float>(grid.planes) / 2;
    all.ray[i] = {x + spread(random) - s * z, y + spread(random) - t * z, s, t};
  }
  all.size = all.pixels = all.ray.size();
  RayCounter counter(grid, all.capacity(), 1);
  counter.count(all, {}, least);
  return counter;
}

TEST(VoxelCloud, holds_exactly_the_voxels_at_or_above_the_minimum) {
  const auto grid = unit_grid(61, 33, 7);
  const auto counter = counter_of(grid, 4000, 1, 5);
  VoxelCloud cloud(100000), small(10);
  EXPECT_EQ(cloud.collect(counter), 0U);
  std::size_t next = 0;
  for (int z = 0; z < grid.planes; ++z)
    for (int y = 1; y <= grid.size_y; ++y)
      for (int x = 1; x <= grid.size_x; ++x) {
        if (counter.at(x, y, z) < 5) continue;
        ASSERT_LT(next, cloud.voxels().size());
        const auto& v = cloud.voxels()[next++];
        ASSERT_TRUE(v.x == x && v.y == y && v.z == z && v.count == counter.at(x, y, z));
      }
  EXPECT_EQ(next, cloud.voxels().size());
  EXPECT_EQ(small.collect(counter), next - 10);
}

struct Cloud3 {
  const std::vector<CloudVoxel>& v;
  std::array<double, 3> scale;
  std::size_t kdtree_get_point_count() const { return v.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return (axis == 0 ? v[i].x : axis == 1 ? v[i].y : v[i].z) * scale[axis];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

TEST(ClassifyLocalMaxima, finds_what_a_search_of_the_cloud_in_a_kd_tree_finds) {
  const auto grid = unit_grid(50, 40, 9);
  const auto counter = counter_of(grid, 6000, 3, 4);
  VoxelCloud cloud(100000);
  cloud.collect(counter);
  const std::array<std::int32_t, 3> half{2, 1, 3};
  std::vector<Candidate> candidates;
  candidates.reserve(10000);
  ASSERT_EQ(classify_local_maxima(counter, cloud, half, candidates), 0U);
  // The box is a ball of the maximum norm in axes scaled by the half-widths: search a wider Euclidean ball, then test.
  const Cloud3 points{cloud.voxels(), {1.0 / half[0], 1.0 / half[1], 1.0 / half[2]}};
  using Tree =
      nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud3>, Cloud3, 3, std::size_t>;
  const Tree tree(3, points, {});
  std::size_t next = 0;
  for (std::size_t i = 0; i < cloud.voxels().size(); ++i) {
    const auto& v = cloud.voxels()[i];
    const std::array<double, 3> at{v.x * points.scale[0], v.y * points.scale[1], v.z * points.scale[2]};
    std::vector<std::pair<std::size_t, double>> near;
    tree.radiusSearch(at.data(), 3.01, near, {});
    const bool maximum = std::none_of(near.begin(), near.end(), [&](const auto& pair) {
      const auto& other = cloud.voxels()[pair.first];
      const bool inside = std::abs(other.x - v.x) <= half[0] && std::abs(other.y - v.y) <= half[1] &&
                          std::abs(other.z - v.z) <= half[2];
      return inside && (other.count > v.count || (other.count == v.count && pair.first < i));
    });
    if (!maximum) continue;
    ASSERT_LT(next, candidates.size());
    EXPECT_EQ(candidates[next].x_mm, static_cast<float>(v.x - 1));
    EXPECT_EQ(candidates[next].y_mm, static_cast<float>(v.y - 1));
    EXPECT_EQ(candidates[next++].z_mm, static_cast<float>(v.z));
  }
  EXPECT_EQ(next, candidates.size());
  EXPECT_GT(next, 20U);
}

// DBSCAN by its definition: quadratic, with the border rule that the first cluster to reach a point keeps it.
std::vector<int> naive_dbscan(const std::vector<CloudVoxel>& v, double radius, std::size_t min_points) {
  const auto near = [&](std::size_t a, std::size_t b) {
    return (v[a].x - v[b].x) * (v[a].x - v[b].x) + (v[a].y - v[b].y) * (v[a].y - v[b].y) +
               (v[a].z - v[b].z) * (v[a].z - v[b].z) <=
           radius * radius;
  };
  std::vector<char> core(v.size());
  for (std::size_t i = 0; i < v.size(); ++i) {
    std::size_t count = 0;
    for (std::size_t j = 0; j < v.size(); ++j) count += near(i, j);
    core[i] = count >= min_points;
  }
  std::vector<int> label(v.size(), Dbscan::kNoise);
  int cluster = 0;
  for (std::size_t seed = 0; seed < v.size(); ++seed) {
    if (!core[seed] || label[seed] >= 0) continue;
    label[seed] = cluster;
    for (bool grown = true; grown;) {
      grown = false;
      for (std::size_t i = 0; i < v.size(); ++i)
        for (std::size_t j = 0; label[i] < 0 && j < v.size(); ++j)
          if (core[j] && label[j] == cluster && near(i, j)) label[i] = cluster, grown = true;
    }
    ++cluster;
  }
  return label;
}

TEST(Dbscan, labels_as_its_definition_does) {
  const auto grid = unit_grid(40, 30, 6);
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const auto counter = counter_of(grid, 1500, seed, 5);
    VoxelCloud cloud(100000);
    cloud.collect(counter);
    ASSERT_GT(cloud.voxels().size(), 50U);
    for (const double radius : {1.0, 1.7321, 1.9999, 2.5})
      for (const std::size_t min_points : {1U, 3U, 6U}) {
        Dbscan dbscan(grid, cloud.capacity(), radius, min_points);
        const auto expected = naive_dbscan(cloud.voxels(), radius, min_points);
        for (int repeat = 0; repeat < 2; ++repeat) {
          const auto& labels = dbscan.label(cloud);
          ASSERT_EQ(std::vector<int>(labels.begin(), labels.end()), expected) << radius << ' ' << min_points;
        }
      }
  }
}

TEST(Dbscan, candidates_are_the_average_positions_of_clusters) {
  const auto grid = unit_grid(40, 30, 6);
  const auto counter = counter_of(grid, 1500, 5, 5);
  VoxelCloud cloud(100000);
  cloud.collect(counter);
  Dbscan dbscan(grid, cloud.capacity(), 1.75, 2);
  std::vector<Candidate> candidates;
  candidates.reserve(1000);
  ASSERT_EQ(dbscan.classify(counter, cloud, candidates), 0U);
  const auto labels = naive_dbscan(cloud.voxels(), 1.75, 2);
  ASSERT_FALSE(candidates.empty());
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    double x = 0, z = 0, n = 0;
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (labels[i] == static_cast<int>(k)) x += cloud.voxels()[i].x - 1, z += cloud.voxels()[i].z, n += 1;
    EXPECT_NEAR(candidates[k].x_mm, x / n, 1e-4);
    EXPECT_NEAR(candidates[k].z_mm, z / n, 1e-4);
  }
}

}  // namespace
}  // namespace rptv
