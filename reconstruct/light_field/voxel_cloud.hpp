// SPDX-License-Identifier: MIT
// The voxels at or above C_min, and the candidates that classification makes of them.
#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/light_field/coarse_maxima_kernel.hpp"
#include "reconstruct/light_field/ray_counter.hpp"

namespace rptv {

/// An inner voxel (1 … size along x and y) and its counter.
struct CloudVoxel {
  std::int32_t x, y, z;
  std::uint16_t count;
};

/// Candidate at (fractional) voxel numbers.
Candidate candidate_at(const RayCounter& counter, double x, double y, double z) noexcept;

/// Voxels in raster order (z slowest). Capacity is fixed by the constructor.
class VoxelCloud {
 public:
  explicit VoxelCloud(std::size_t capacity) { voxels_.reserve(capacity); }

  /// Takes every inner voxel that the counter has marked. Returns how many did not fit. Allocates nothing.
  std::size_t collect(const RayCounter& counter) noexcept;

  void clear() noexcept { voxels_.clear(); }
  /// Voxels must come in raster order. False when there is no room.
  bool add(const CloudVoxel& voxel) noexcept {
    if (voxels_.size() == voxels_.capacity()) return false;
    voxels_.push_back(voxel);
    return true;
  }

  const std::vector<CloudVoxel>& voxels() const noexcept { return voxels_; }
  std::size_t capacity() const noexcept { return voxels_.capacity(); }

 private:
  std::vector<CloudVoxel> voxels_;
};

}  // namespace rptv
