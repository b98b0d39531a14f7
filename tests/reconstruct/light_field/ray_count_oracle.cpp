// SPDX-License-Identifier: MIT
// The plain loops; compiled for FMA where the processor has it, else fmaf() would be most of their time.
#include "tests/reconstruct/light_field/ray_count_oracle.hpp"

#include <algorithm>
#include <array>

namespace rptv::testing {

namespace {

[[gnu::always_inline]] inline void count_one(std::uint16_t& counter) noexcept {
  counter = static_cast<std::uint16_t>(counter + (counter != 0xffff));
}

[[gnu::always_inline]] inline void ray_major(const VoxelGrid& grid, const Rays& rays, std::uint16_t* counts) {
  for (const Ray& ray : rays.all()) {
    const VoxelRay in_voxels = to_voxels(grid, ray);
    for (std::int32_t z = 0; z < grid.planes; ++z)
      count_one(counts[static_cast<std::ptrdiff_t>(z) * grid.plane_size() + voxel_of(grid, in_voxels, grid.z_mm(z))]);
  }
}

[[gnu::always_inline]] inline void plane_major(const VoxelGrid& grid, const std::vector<VoxelRay>& rays,
                                               std::uint16_t* counts) {
  constexpr std::size_t kBlock = 256;
  std::array<std::int32_t, kBlock> voxel;
  for (std::int32_t z = 0; z < grid.planes; ++z, counts += grid.plane_size())
    for (std::size_t first = 0; first < rays.size(); first += kBlock) {
      const std::size_t count = std::min(kBlock, rays.size() - first);
      for (std::size_t i = 0; i < count; ++i) voxel[i] = voxel_of(grid, rays[first + i], grid.z_mm(z));
      for (std::size_t i = 0; i < count; ++i) count_one(counts[voxel[i]]);
    }
}

#if defined(__x86_64__)
[[gnu::target("avx2,fma")]] void ray_major_fma(const VoxelGrid& grid, const Rays& rays, std::uint16_t* counts) {
  ray_major(grid, rays, counts);
}
[[gnu::target("avx2,fma")]] void plane_major_fma(const VoxelGrid& grid, const std::vector<VoxelRay>& rays,
                                                 std::uint16_t* counts) {
  plane_major(grid, rays, counts);
}
const bool kFma = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#endif

void clear(const VoxelGrid& grid, Counts& counts) {
  counts.assign(static_cast<std::size_t>(grid.plane_size()) * static_cast<std::size_t>(grid.planes), 0);
}

}  // namespace

void count_ray_major(const VoxelGrid& grid, const Rays& rays, Counts& counts) {
  clear(grid, counts);
#if defined(__x86_64__)
  if (kFma) return ray_major_fma(grid, rays, counts.data());
#endif
  ray_major(grid, rays, counts.data());
}

void count_plane_major(const VoxelGrid& grid, const Rays& rays, Counts& counts) {
  clear(grid, counts);
  std::vector<VoxelRay> in_voxels;
  in_voxels.reserve(rays.size);
  for (const Ray& ray : rays.all()) in_voxels.push_back(to_voxels(grid, ray));
#if defined(__x86_64__)
  if (kFma) return plane_major_fma(grid, in_voxels, counts.data());
#endif
  plane_major(grid, in_voxels, counts.data());
}

std::size_t voxels_at(const VoxelGrid& grid, const Counts& counts, std::uint16_t least) {
  std::size_t found = 0;
  for (std::int32_t z = 0; z < grid.planes; ++z)
    for (std::int32_t y = 1; y <= grid.size_y; ++y) {
      const std::uint16_t* row = counts.data() + static_cast<std::ptrdiff_t>(z) * grid.plane_size() + grid.index(0, y);
      for (std::int32_t x = 1; x <= grid.size_x; ++x) found += row[x] >= least;
    }
  return found;
}

}  // namespace rptv::testing
