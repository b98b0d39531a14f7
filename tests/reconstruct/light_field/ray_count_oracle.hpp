// SPDX-License-Identifier: MIT
// Eq. (6) written down plainly, twice: what the fast ray counter must equal, and what it is measured against.
#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/light_field/ray_count_kernel.hpp"
#include "reconstruct/light_field/rays.hpp"

namespace rptv::testing {

/// Counters of all planes, border included, cleared first; they stop at 65535.
using Counts = std::vector<std::uint16_t>;

/// Ray by ray, as eq. (6) reads: each ray through all planes.
void count_ray_major(const VoxelGrid& grid, const Rays& rays, Counts& counts);

/// Plane by plane: rays in blocks whose voxel numbers are computed side by side.
void count_plane_major(const VoxelGrid& grid, const Rays& rays, Counts& counts);

/// Scan of all inner voxels: how many have at least `least` rays.
std::size_t voxels_at(const VoxelGrid& grid, const Counts& counts, std::uint16_t least);

}  // namespace rptv::testing
