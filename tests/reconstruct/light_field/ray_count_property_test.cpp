// SPDX-License-Identifier: MIT
// The fast ray counter against the plain loops, bit for bit, with every instruction set that this machine has.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "reconstruct/light_field/ray_counter.hpp"
#include "tests/core/instruction_sets.hpp"
#include "tests/reconstruct/light_field/any_rays.hpp"
#include "tests/reconstruct/light_field/ray_count_oracle.hpp"

namespace rptv {
namespace {

using testing::AnyRays;

void expect_marks(const RayCounter& counter, const testing::Counts& counts, std::uint16_t least) {
  const auto plane = static_cast<std::size_t>(counter.grid().plane_size());
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const auto marks = counter.marks(static_cast<std::int32_t>(i / plane));
    RC_ASSERT((marks[i % plane / 64] >> (i % plane % 64) & 1) == (counts[i] >= least));
  }
}

void expect_equal(const RayCounter& counter, const testing::Counts& counts) {
  for (std::int32_t z = 0; z < counter.grid().planes; ++z) {
    const auto plane = counter.plane(z);
    RC_ASSERT(std::equal(plane.begin(), plane.end(), counts.begin() + std::ptrdiff_t{z} * counter.grid().plane_size()));
  }
}

RC_GTEST_PROP(RayCounter, equals_the_plain_loops_bit_for_bit, ()) {
  const AnyRays any = testing::any_rays();
  const auto least = *rc::gen::inRange<std::uint16_t>(1, 40);
  testing::Counts by_rays, by_planes;
  testing::count_ray_major(any.grid, any.rays, by_rays);
  testing::count_plane_major(any.grid, any.rays, by_planes);
  RC_ASSERT(by_rays == by_planes);
  for (const auto set : testing::sets_here()) {
    RayCounter counter(any.grid, any.rays.capacity(), 2, set);
    for (int repeat = 0; repeat < 2; ++repeat) {
      counter.count(any.rays, {}, least);
      expect_equal(counter, by_rays);
      expect_marks(counter, by_rays, least);
    }
  }
}

RC_GTEST_PROP(RayCounter, leaves_out_taken_rays_with_every_instruction_set, ()) {
  AnyRays any = testing::any_rays();
  std::vector<std::uint8_t> taken(any.rays.size);
  Rays free(any.rays.capacity(), 1);
  for (std::size_t i = 0; i < any.rays.size; ++i) {
    taken[i] = i % 3 == 0;
    if (i % 3 != 0) free.ray[free.size++] = any.rays.ray[i];
  }
  testing::Counts counts;
  testing::count_ray_major(any.grid, free, counts);
  for (const auto set : testing::sets_here()) {
    RayCounter counter(any.grid, any.rays.capacity(), 1, set);
    counter.count(any.rays, taken, 1);
    expect_equal(counter, counts);
  }
}

TEST(RayCounter, equals_the_plain_loops_in_planes_too_large_for_the_cache) {
  AnyRays large;
  large.grid.size_x = 700, large.grid.size_y = 301, large.grid.planes = 19, large.grid.first_z_mm = -9;
  large.rays = Rays(20000, 1);
  std::mt19937 random(4);
  std::uniform_real_distribution<float> x(-5, 710), y(-5, 310), slope(-0.1F, 0.1F);
  for (auto& ray : large.rays.ray) ray = {x(random), y(random), slope(random), slope(random)};
  large.rays.size = large.rays.pixels = large.rays.capacity();
  testing::Counts counts;
  testing::count_ray_major(large.grid, large.rays, counts);
  for (const auto set : testing::sets_here()) {
    RayCounter counter(large.grid, large.rays.capacity(), 2, set);
    counter.count(large.rays, {}, 3);
    for (std::int32_t z = 0; z < large.grid.planes; ++z)
      ASSERT_TRUE(std::equal(counter.plane(z).begin(), counter.plane(z).end(),
                             counts.begin() + std::ptrdiff_t{z} * large.grid.plane_size()))
          << z << ' ' << name_of(set);
  }
}

// Two voxels beyond 65535, one of them at exactly 65536 more than a neighbour: sums modulo 2^16 would hide it.
TEST(RayCounter, stops_at_65535_where_the_plain_loops_do) {
  VoxelGrid grid;
  grid.size_x = 5, grid.size_y = 4, grid.planes = 19, grid.step_z_mm = 1;
  Rays rays(65536 + 70000 + 10, 1);
  rays.size = rays.pixels = rays.capacity();
  for (std::size_t i = 0; i < rays.size; ++i)
    rays.ray[i] = i < 65536 ? Ray{0, 0, 0.1F, 0} : i < 65536 + 70000 ? Ray{3, 2, 0, 0.2F} : Ray{1, 1, 0, 0};
  testing::Counts counts;
  testing::count_ray_major(grid, rays, counts);
  ASSERT_EQ(std::count(counts.begin(), counts.end(), 65535), 2 * grid.planes);
  for (const auto set : testing::sets_here()) {
    RayCounter counter(grid, rays.capacity(), 1, set);
    counter.count(rays, {}, 11);
    for (std::int32_t z = 0; z < grid.planes; ++z)
      ASSERT_TRUE(std::equal(counter.plane(z).begin(), counter.plane(z).end(),
                             counts.begin() + std::ptrdiff_t{z} * grid.plane_size()))
          << z << ' ' << name_of(set);
  }
}

}  // namespace
}  // namespace rptv
