// SPDX-License-Identifier: MIT
// The seed's timing case: rays through points in its volumes, in the order in which a sensor gives them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "reconstruct/light_field/ray_count_kernel.hpp"
#include "reconstruct/light_field/rays.hpp"

namespace rptv::bench {

struct TimingCase {
  VoxelGrid grid;  ///< unit voxels; the array plane, where lenslets are a voxel wide, is in the middle of the planes
  Rays rays{0, 1};
  std::vector<std::array<double, 3>> points;  ///< column, row, z in voxels: what the rays go through
};

/// `rays` rays of slopes up to `slope` voxels a plane per axis through `points` points; starts quantised by lenslets,
/// sorted by lenslet in raster order. Deterministic.
TimingCase make_timing_case(std::int32_t size_x, std::int32_t size_y, std::int32_t planes, std::size_t rays,
                            std::size_t points, double slope);

}  // namespace rptv::bench
