// SPDX-License-Identifier: MIT
// The ray counter against brute force in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "reconstruct/light_field/ray_counter.hpp"

namespace rptv {
namespace {

VoxelGrid grid_of(int x, int y, int planes) {
  VoxelGrid grid;
  grid.step_x_mm = 0.125F, grid.step_y_mm = 0.11F, grid.step_z_mm = 0.7F;
  grid.size_x = x, grid.size_y = y, grid.planes = planes;
  grid.first_x_mm = -0.5F * 0.125F * static_cast<float>(x - 1),
  grid.first_y_mm = -0.5F * 0.11F * static_cast<float>(y - 1);
  grid.first_z_mm = -0.35F * static_cast<float>(planes - 1);
  return grid;
}

Rays random_rays(std::size_t count, unsigned seed) {
  Rays rays(count, 1);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> at(-3, 3), slope(-0.08F, 0.08F);
  for (std::size_t i = 0; i < count; ++i) {
    rays.ray[i] = {at(random), at(random), slope(random), slope(random)};
    rays.pixel[i] = static_cast<std::uint32_t>(i);
  }
  rays.size = rays.pixels = count;
  return rays;
}

// Nearest voxel of a ray on a plane, in double precision; false when it is too close to a face to tell.
bool nearest(double at, double first, double step, long& voxel) {
  const double position = (at - first) / step;
  voxel = std::lround(position);
  return std::abs(position - std::floor(position) - 0.5) > 1e-4;
}

TEST(RayCounter, counts_each_ray_once_on_each_plane_in_its_nearest_voxel) {
  const VoxelGrid grid = grid_of(37, 41, 23);
  const Rays rays = random_rays(5000, 7);
  RayCounter counter(grid, rays.capacity(), 1);
  counter.count(rays, {}, 1);
  std::uint64_t undecided = 0, differences = 0;
  for (int z = 0; z < grid.planes; ++z) {
    std::map<std::pair<long, long>, int> expected;
    const double depth = static_cast<double>(grid.first_z_mm) + z * static_cast<double>(grid.step_z_mm);
    for (const Ray& ray : rays.all()) {
      long x = 0, y = 0;
      const bool sure_x = nearest(ray.centre_x + ray.slope_x * depth, grid.first_x_mm, grid.step_x_mm, x);
      const bool sure_y = nearest(ray.centre_y + ray.slope_y * depth, grid.first_y_mm, grid.step_y_mm, y);
      undecided += !(sure_x && sure_y);
      ++expected[{x, y}];
    }
    std::uint64_t sum = 0;
    for (const auto count : counter.plane(z)) sum += count;
    EXPECT_EQ(sum, rays.size);
    for (int y = 0; y < grid.size_y; ++y)
      for (int x = 0; x < grid.size_x; ++x)
        differences += static_cast<std::uint64_t>(std::abs(counter.at(x + 1, y + 1, z) - expected[{x, y}]));
  }
  EXPECT_LE(differences, 2 * undecided);  // a ray on a face may be counted on either side
  EXPECT_LT(undecided, 5000U * 23 / 500);
}

TEST(RayCounter, gives_the_same_integers_with_any_number_of_threads) {
  const VoxelGrid grid = grid_of(40, 30, 50);
  const Rays rays = random_rays(3000, 9);
  RayCounter one(grid, rays.capacity(), 1), three(grid, rays.capacity(), 3);
  one.count(rays, {}, 1);
  three.count(rays, {}, 1);
  for (int z = 0; z < grid.planes; ++z)
    ASSERT_TRUE(std::equal(one.plane(z).begin(), one.plane(z).end(), three.plane(z).begin()));
}

TEST(RayCounter, agrees_with_its_own_kernel_called_ray_by_ray) {
  const VoxelGrid grid = grid_of(33, 29, 11);
  const Rays rays = random_rays(1000, 5);
  RayCounter counter(grid, rays.capacity(), 1);
  counter.count(rays, {}, 1);
  for (int z = 0; z < grid.planes; ++z) {
    std::vector<int> counts(static_cast<std::size_t>(grid.plane_size()));
    for (const Ray& ray : rays.all())
      ++counts[static_cast<std::size_t>(voxel_of(grid, to_voxels(grid, ray), grid.z_mm(z)))];
    for (std::size_t i = 0; i < counts.size(); ++i) ASSERT_EQ(counter.plane(z)[i], counts[i]);  // bit for bit
  }
}

TEST(RayCounter, leaves_out_taken_rays_and_forgets_the_last_frame) {
  const VoxelGrid grid = grid_of(20, 20, 4);
  const Rays rays = random_rays(100, 2);
  RayCounter counter(grid, rays.capacity(), 1);
  counter.count(rays, {}, 1);
  std::vector<std::uint8_t> taken(100, 1);
  taken[3] = taken[50] = 0;
  counter.count(rays, taken, 1);
  std::uint64_t sum = 0;
  for (const auto count : counter.plane(2)) sum += count;
  EXPECT_EQ(sum, 2U);
}

TEST(RayCounter, stops_at_the_largest_count_instead_of_wrapping) {
  const VoxelGrid grid = grid_of(3, 3, 1);
  Rays rays(70000, 1);
  for (auto& ray : rays.ray) ray = {0, 0, 0, 0};
  rays.size = rays.pixels = 70000;
  RayCounter counter(grid, rays.capacity(), 1);
  counter.count(rays, {}, 1);
  EXPECT_EQ(counter.at(2, 2, 0), 65535);
}

}  // namespace
}  // namespace rptv
