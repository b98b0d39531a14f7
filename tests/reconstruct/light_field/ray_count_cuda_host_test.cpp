// SPDX-License-Identifier: MIT
// The device's ray counter, run on the CPU, against the plain loops, bit for bit.
#include "reconstruct/light_field/ray_count_cuda.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/reconstruct/light_field/any_rays.hpp"
#include "tests/reconstruct/light_field/device_copies.hpp"
#include "tests/reconstruct/light_field/ray_count_oracle.hpp"

namespace rptv {
namespace {

using testing::Counts;
using testing::from_device;
using testing::on_device;

// Counts of all planes by the device; empty `taken`: null there. `room` is the capacity beyond the rays.
Counts count_on_device(const VoxelGrid& grid, const Rays& rays, const std::vector<std::uint8_t>& taken,
                       unsigned threads, std::size_t room = 7) {
  CudaStream stream;
  const std::size_t capacity = rays.size + room, chunks = ray_chunks(capacity);
  std::vector<Ray> all(rays.ray.begin(), rays.ray.begin() + static_cast<std::ptrdiff_t>(rays.size));
  all.resize(capacity, {1, 1, 0, 0});  // old rays behind the last one
  const auto ray = on_device(stream, all);
  const auto size = on_device<std::uint32_t>(stream, {static_cast<std::uint32_t>(rays.size)});
  const auto device_taken = on_device(stream, taken);
  const DeviceArray<VoxelRay> voxel_rays(chunks * RayChunk::kRays);
  const DeviceArray<RayChunk> chunk_array(chunks);
  const DeviceArray<std::uint16_t> counts(static_cast<std::size_t>(grid.plane_size() * grid.planes));
  CudaRays on{};
  on.ray = ray.data(), on.size = size.data(), on.capacity = static_cast<std::uint32_t>(capacity);
  EXPECT_TRUE(count_rays_cuda(grid, on, taken.empty() ? nullptr : device_taken.data(),
                              {voxel_rays.data(), chunk_array.data(), counts.data()}, stream.handle(), threads));
  return from_device(stream, counts);
}

RC_GTEST_PROP(CudaRayCount, equals_the_plain_loops_bit_for_bit, ()) {
  const auto any = testing::any_rays();
  Counts expected;
  testing::count_ray_major(any.grid, any.rays, expected);
  cuda_host::set_schedule_seed(*rc::gen::element<std::uint64_t>(0, 1, 5));
  const auto threads = *rc::gen::elementOf(std::vector<unsigned>{32, 96, 256});
  RC_ASSERT(count_on_device(any.grid, any.rays, {}, threads) == expected);
}

RC_GTEST_PROP(CudaRayCount, leaves_out_taken_rays, ()) {
  const auto any = testing::any_rays();
  std::vector<std::uint8_t> taken(any.rays.size + 7);
  Rays free(any.rays.capacity(), 1);
  for (std::size_t i = 0; i < any.rays.size; ++i) {
    taken[i] = i % 3 == 0;
    if (i % 3 != 0) free.ray[free.size++] = any.rays.ray[i];
  }
  Counts expected;
  testing::count_ray_major(any.grid, free, expected);
  RC_ASSERT(count_on_device(any.grid, any.rays, taken, 96) == expected);
}

TEST(CudaRayCount, counts_planes_wider_and_longer_than_a_tile) {
  VoxelGrid grid;
  grid.size_x = 2500, grid.size_y = 41, grid.planes = 3, grid.first_z_mm = -1;
  Rays rays(testing::kWatchesRaces ? 501 : 20001, 1);
  std::mt19937 random(4);
  std::uniform_real_distribution<float> x(-5, 2510), y(-5, 50), slope(-0.3F, 0.3F);
  for (auto& ray : rays.ray) ray = {x(random), y(random), slope(random), slope(random)};
  rays.size = rays.capacity();
  Counts expected;
  testing::count_ray_major(grid, rays, expected);
  for (const auto seed : testing::kSchedules) {
    cuda_host::set_schedule_seed(seed);
    for (const unsigned threads : testing::kBlockSizes)
      EXPECT_EQ(count_on_device(grid, rays, {}, threads), expected) << threads;
  }
}

// Bounds of a chunk must not lose the ray that is nowhere, which the plain loops count in the first row.
TEST(CudaRayCount, counts_a_ray_that_is_no_number_among_far_neighbours) {
  VoxelGrid grid;
  grid.size_x = 50, grid.size_y = 120, grid.planes = 5, grid.first_z_mm = -2;
  Rays rays(300, 1);
  rays.size = rays.capacity();
  for (auto& ray : rays.ray) ray = {20, 110, 0.1F, 0.1F};
  rays.ray[40].slope_y = rays.ray[290].centre_y = std::numeric_limits<float>::quiet_NaN();
  Counts expected;
  testing::count_ray_major(grid, rays, expected);
  EXPECT_EQ(count_on_device(grid, rays, {}, 96), expected);
}

TEST(CudaRayCount, counts_more_rays_than_threads_and_stops_at_65535) {
  if (testing::kWatchesRaces) GTEST_SKIP() << "takes minutes; the other tests show races as well";
  VoxelGrid grid;
  grid.size_x = 5, grid.size_y = 4, grid.planes = 3;
  Rays rays(65536 + 70000 + 10, 1);
  rays.size = rays.capacity();
  for (std::size_t i = 0; i < rays.size; ++i)
    rays.ray[i] = i < 65536 ? Ray{0, 0, 0.1F, 0} : i < 65536 + 70000 ? Ray{3, 2, 0, 0.2F} : Ray{1, 1, 0, 0};
  Counts expected;
  testing::count_ray_major(grid, rays, expected);
  ASSERT_EQ(std::count(expected.begin(), expected.end(), 65535), 2 * grid.planes);
  EXPECT_EQ(count_on_device(grid, rays, {}, 256, 0), expected);
}

TEST(CudaRayCount, clears_the_counters_when_there_is_no_ray) {
  VoxelGrid grid;
  grid.size_x = 33, grid.size_y = 9, grid.planes = 2;
  const Counts counts = count_on_device(grid, Rays(0, 1), {}, 96);
  EXPECT_EQ(counts, Counts(counts.size(), 0));
}

// The seed's volume: 400 × 200 cells, 150 planes; rays as lit pixels of particles give them.
TEST(CudaRayCount, counts_the_volume_of_the_proposal) {
  if (testing::kWatchesRaces) GTEST_SKIP() << "takes minutes; the other tests show races as well";
  VoxelGrid grid;
  grid.size_x = 400, grid.size_y = 200, grid.planes = 150;
  grid.step_x_mm = grid.step_y_mm = 0.125F, grid.step_z_mm = 0.25F, grid.first_z_mm = -18.625F;
  Rays rays(10007, 1);
  std::mt19937 random(9);
  std::uniform_real_distribution<float> x(0, 50), y(0, 25), slope(-0.04F, 0.04F);
  for (auto& ray : rays.ray) ray = {x(random), y(random), slope(random), slope(random)};
  rays.size = rays.capacity();
  Counts expected;
  testing::count_ray_major(grid, rays, expected);
  EXPECT_EQ(count_on_device(grid, rays, {}, 256), expected);
}

}  // namespace
}  // namespace rptv
