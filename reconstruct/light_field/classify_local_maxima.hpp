// SPDX-License-Identifier: MIT
// Dense clouds: a candidate is a voxel whose counter nothing near it exceeds.
#pragma once

#include <array>
#include <vector>

#include "reconstruct/light_field/voxel_cloud.hpp"

namespace rptv {

/// Appends to `candidates` (up to its capacity) each voxel of the cloud that has the highest counter in the box of
/// `half_width` voxels round it; among equals the first in raster order wins. The neighbour search of the seed's k-d
/// tree is a look-up here, since the points lie on a grid: exact, and without allocation. Returns how many did not fit.
std::size_t classify_local_maxima(const RayCounter& counter, const VoxelCloud& cloud,
                                  const std::array<std::int32_t, 3>& half_width,
                                  std::vector<Candidate>& candidates) noexcept;

}  // namespace rptv
