// SPDX-License-Identifier: MIT
// Loops of the ray counter: planes over threads, rays in blocks whose voxel numbers are computed side by side.
#include <algorithm>
#include <array>

#include "reconstruct/parallel.hpp"
#include "reconstruct/ray_counter.hpp"

namespace rptv {

namespace {

struct VoxelRays {
  const float *column, *row, *column_slope, *row_slope;
  std::size_t size;
};

constexpr std::size_t kBlock = 256;

// Written once, compiled twice: fmaf() is one instruction where the processor has it and a slow, exact call where not.
[[gnu::always_inline]] inline void count_plane(const VoxelGrid& grid, const VoxelRays& rays, float z_mm,
                                               std::uint16_t* counts) noexcept {
  std::array<std::int32_t, kBlock> voxel;
  for (std::size_t first = 0; first < rays.size; first += kBlock) {
    const std::size_t count = std::min(kBlock, rays.size - first);
    for (std::size_t i = 0; i < count; ++i)
      voxel[i] = voxel_of(
          grid, {rays.column[first + i], rays.row[first + i], rays.column_slope[first + i], rays.row_slope[first + i]},
          z_mm);
    for (std::size_t i = 0; i < count; ++i) {
      auto& counter = counts[voxel[i]];
      counter = static_cast<std::uint16_t>(counter + (counter != 0xffff));
    }
  }
}

using CountPlane = void (*)(const VoxelGrid&, const VoxelRays&, float, std::uint16_t*) noexcept;

void count_plane_portable(const VoxelGrid& grid, const VoxelRays& rays, float z_mm, std::uint16_t* counts) noexcept {
  count_plane(grid, rays, z_mm, counts);
}

#if defined(__x86_64__)
[[gnu::target("avx2,fma")]] void count_plane_fma(const VoxelGrid& grid, const VoxelRays& rays, float z_mm,
                                                 std::uint16_t* counts) noexcept {
  count_plane(grid, rays, z_mm, counts);
}
#endif

CountPlane best_count_plane() noexcept {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return count_plane_fma;
#endif
  return count_plane_portable;
}

}  // namespace

RayCounter::RayCounter(const VoxelGrid& grid, std::size_t max_rays, std::size_t threads)
    : grid_(grid),
      threads_(threads),
      column_(max_rays),
      row_(max_rays),
      column_slope_(max_rays),
      row_slope_(max_rays),
      counts_(static_cast<std::size_t>(grid.plane_size()) * static_cast<std::size_t>(grid.planes)) {}

void RayCounter::count(const Rays& rays, std::span<const std::uint8_t> taken) noexcept {
  rays_ = 0;
  for (std::size_t i = 0; i < rays.size; ++i) {
    if (!taken.empty() && taken[rays.pixel[i]] != 0) continue;
    const VoxelRay ray = to_voxels(grid_, rays.ray[i]);
    column_[rays_] = ray.column, row_[rays_] = ray.row;
    column_slope_[rays_] = ray.column_slope, row_slope_[rays_] = ray.row_slope;
    ++rays_;
  }
  static const CountPlane count_one = best_count_plane();
  const VoxelRays all{column_.data(), row_.data(), column_slope_.data(), row_slope_.data(), rays_};
  const auto size = static_cast<std::size_t>(grid_.plane_size());
  parallel_for(static_cast<std::size_t>(grid_.planes), threads_, [&](std::size_t z, std::size_t) {
    std::uint16_t* counts = counts_.data() + z * size;
    std::fill(counts, counts + size, std::uint16_t{0});
    count_one(grid_, all, grid_.z_mm(static_cast<std::int32_t>(z)), counts);
  });
}

}  // namespace rptv
