// SPDX-License-Identifier: MIT
// The arithmetic of the ray counter, eq. (6): which voxel a ray goes through on a plane. Host and device.
#pragma once

#include <cmath>
#include <cstdint>

#include "reconstruct/host_device.hpp"
#include "reconstruct/light_field/ray.hpp"

namespace rptv {

/// Voxels of image space. Each plane has a border of one voxel all round (ring 0 and size + 1) that collects the rays
/// that leave the volume sideways, so that no neighbour of an inner voxel is outside the array.
struct VoxelGrid {
  float first_x_mm = 0, first_y_mm = 0, first_z_mm = 0;  ///< centre of inner voxel (1, 1) of plane 0
  float step_x_mm = 1, step_y_mm = 1, step_z_mm = 1;
  std::int32_t size_x = 0, size_y = 0, planes = 0;  ///< without the border

  RPTV_HOST_DEVICE std::int32_t stride() const noexcept { return size_x + 2; }
  RPTV_HOST_DEVICE std::int32_t plane_size() const noexcept { return stride() * (size_y + 2); }
  RPTV_HOST_DEVICE std::int32_t index(std::int32_t x, std::int32_t y) const noexcept { return y * stride() + x; }
  RPTV_HOST_DEVICE float z_mm(std::int32_t plane) const noexcept {
    return fmaf(static_cast<float>(plane), step_z_mm, first_z_mm);
  }
};

/// A ray in units of voxels: at depth z it is at column + column_slope·z, row + row_slope·z; the centre of voxel
/// (x, y) is at (x + 0.5, y + 0.5). Aligned for loads of 16 bytes.
struct alignas(16) VoxelRay {
  float column, row, column_slope, row_slope;
};

RPTV_HOST_DEVICE inline VoxelRay to_voxels(const VoxelGrid& grid, const Ray& ray) noexcept {
  const float per_x = 1.0F / grid.step_x_mm, per_y = 1.0F / grid.step_y_mm;
  return {fmaf(ray.centre_x - grid.first_x_mm, per_x, 1.5F), fmaf(ray.centre_y - grid.first_y_mm, per_y, 1.5F),
          ray.slope_x * per_x, ray.slope_y * per_y};
}

/// Position along one axis at depth z to the nearest voxel's number, 0 … size + 1: eq. (6) and rounding. fmaf is
/// written out so that every backend gives the same integer.
RPTV_HOST_DEVICE inline std::int32_t nearest_voxel(float position, float slope, float z_mm,
                                                   std::int32_t size) noexcept {
  const float at = fmaf(slope, z_mm, position);
  const float last = static_cast<float>(size + 1);
  const float inside = at > 0.0F ? (at < last ? at : last) : 0.0F;
  return static_cast<std::int32_t>(inside);
}

/// Index into a plane of the voxel that the ray goes through.
RPTV_HOST_DEVICE inline std::int32_t voxel_of(const VoxelGrid& grid, const VoxelRay& ray, float z_mm) noexcept {
  return grid.index(nearest_voxel(ray.column, ray.column_slope, z_mm, grid.size_x),
                    nearest_voxel(ray.row, ray.row_slope, z_mm, grid.size_y));
}

}  // namespace rptv
