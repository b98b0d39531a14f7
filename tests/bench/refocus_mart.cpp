// SPDX-License-Identifier: MIT
// Refocusing and MART: both walk along rays plane by plane.
#include <algorithm>
#include <cmath>

#include "tests/bench/baselines.hpp"

namespace rptv::bench {

namespace {

#define RPTV_FMA [[gnu::target("avx2,fma")]]
#if !defined(__x86_64__)
#undef RPTV_FMA
#define RPTV_FMA
#endif

// The voxels of a plane that a ray belongs to, and with which weights.
struct Footprint {
  std::size_t index[4];
  float weight[4];
};

// `at` is in voxels from the centre of voxel 0. False outside of the volume.
RPTV_FMA inline bool bilinear_at(const VoxelVolume& v, float x, float y, std::size_t z, Footprint& f) {
  const float low_x = std::floor(x), low_y = std::floor(y);
  if (!(low_x >= 0 && low_y >= 0)) return false;
  const auto i = static_cast<std::size_t>(low_x), j = static_cast<std::size_t>(low_y);
  if (i + 1 >= v.size[0] || j + 1 >= v.size[1]) return false;
  const float u = x - low_x, w = y - low_y;
  f = {{v.column(i, j) + z, v.column(i + 1, j) + z, v.column(i, j + 1) + z, v.column(i + 1, j + 1) + z},
       {(1 - u) * (1 - w), u * (1 - w), (1 - u) * w, u * w}};
  return true;
}

// All voxels along a ray with their weights, into arrays of 4 for each plane; returns how many.
RPTV_FMA std::size_t trace(const VoxelVolume& v, const VoxelRay& ray, bool bilinear, std::vector<std::size_t>& index,
                           std::vector<float>& weight) {
  std::size_t count = 0;
  for (std::size_t z = 0; z < v.size[2]; ++z) {
    const float z_mm = v.grid.z_mm(static_cast<std::int32_t>(z));
    const float x = fmaf(ray.column_slope, z_mm, ray.column) - 1.5F, y = fmaf(ray.row_slope, z_mm, ray.row) - 1.5F;
    if (bilinear) {
      Footprint f;
      if (!bilinear_at(v, x, y, z, f)) continue;
      for (int k = 0; k < 4; ++k) index[count] = f.index[k], weight[count++] = f.weight[k];
    } else {
      const float near_x = x + 0.5F, near_y = y + 0.5F;
      if (!(near_x >= 0 && near_y >= 0)) continue;
      const auto i = static_cast<std::size_t>(near_x), j = static_cast<std::size_t>(near_y);
      if (i < v.size[0] && j < v.size[1]) index[count++] = v.column(i, j) + z;
    }
  }
  return count;
}

RPTV_FMA void correct_nearest(const std::vector<std::size_t>& index, std::size_t count, float grey, float* value) {
  float sum = 0;
  for (std::size_t k = 0; k < count; ++k) sum += value[index[k]];
  const float ratio = sum > 0 ? grey / sum : 1;
  for (std::size_t k = 0; k < count; ++k) value[index[k]] *= ratio;
}

RPTV_FMA void correct_bilinear(const std::vector<std::size_t>& index, const std::vector<float>& weight,
                               std::size_t count, float grey, float* value) {
  float sum = 0;
  for (std::size_t k = 0; k < count; ++k) sum += weight[k] * value[index[k]];
  if (!(sum > 0)) return;
  const float log_ratio = std::log(grey / sum);
  for (std::size_t k = 0; k < count; ++k) value[index[k]] *= std::exp(weight[k] * log_ratio);  // eq. (2)
}

}  // namespace

RPTV_FMA void refocus(const Rays& rays, std::span<const float> grey, double views, VoxelVolume& out) {
  std::fill(out.value.begin(), out.value.end(), 0.0F);
  std::vector<std::size_t> index(4 * out.size[2]);
  std::vector<float> weight(4 * out.size[2]);
  const auto share = static_cast<float>(1 / views);
  for (std::size_t i = 0; i < rays.size; ++i) {
    const std::size_t count = trace(out, to_voxels(out.grid, rays.ray[i]), true, index, weight);
    for (std::size_t k = 0; k < count; ++k) out.value[index[k]] += share * grey[i] * weight[k];
  }
}

RPTV_FMA void mart(const Rays& rays, std::span<const float> grey, bool bilinear, int iterations, VoxelVolume& out) {
  std::fill(out.value.begin(), out.value.end(), 0.0F);
  std::vector<std::size_t> index(4 * out.size[2]);
  std::vector<float> weight(4 * out.size[2]);
  for (std::size_t i = 0; i < rays.size; ++i) {
    const std::size_t count = trace(out, to_voxels(out.grid, rays.ray[i]), bilinear, index, weight);
    for (std::size_t k = 0; k < count; ++k) out.value[index[k]] = 1;
  }
  for (int iteration = 0; iteration < iterations; ++iteration)
    for (std::size_t i = 0; i < rays.size; ++i) {
      const std::size_t count = trace(out, to_voxels(out.grid, rays.ray[i]), bilinear, index, weight);
      bilinear ? correct_bilinear(index, weight, count, grey[i], out.value.data())
               : correct_nearest(index, count, grey[i], out.value.data());
    }
}

VoxelVolume point_spread(const VoxelGrid& grid, double slope_radius) {
  constexpr int kSlopes = 12, kQuanta = 4;
  Rays rays(static_cast<std::size_t>((2 * kSlopes + 1) * (2 * kSlopes + 1) * kQuanta * kQuanta), 1);
  const double centre_x = grid.first_x_mm + grid.size_x / 2 * static_cast<double>(grid.step_x_mm);
  const double centre_y = grid.first_y_mm + grid.size_y / 2 * static_cast<double>(grid.step_y_mm);
  const double centre_z = grid.z_mm(grid.planes / 2);
  for (int j = -kSlopes; j <= kSlopes; ++j)
    for (int i = -kSlopes; i <= kSlopes; ++i)
      for (int q = 0; q < kQuanta * kQuanta && std::hypot(i, j) <= kSlopes; ++q) {
        const double s = slope_radius * i / kSlopes, t = slope_radius * j / kSlopes;
        const double off_x = ((q % kQuanta + 0.5) / kQuanta - 0.5) * static_cast<double>(grid.step_x_mm);
        const double off_y = ((q / kQuanta + 0.5) / kQuanta - 0.5) * static_cast<double>(grid.step_y_mm);
        rays.ray[rays.size++] = {static_cast<float>(centre_x + off_x - s * centre_z),
                                 static_cast<float>(centre_y + off_y - t * centre_z), static_cast<float>(s),
                                 static_cast<float>(t)};
      }
  VoxelVolume psf(grid);
  const std::vector<float> grey(rays.size, 1.0F);
  refocus(rays, grey, static_cast<double>(rays.size) * grid.planes, psf);
  return psf;
}

}  // namespace rptv::bench
