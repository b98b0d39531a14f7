// SPDX-License-Identifier: MIT
// Sparse clouds: voxels are clustered by density (DBSCAN, Ester et al. 1996) and each cluster's centre is a candidate.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "reconstruct/voxel_cloud.hpp"

namespace rptv {

/// A voxel with at least `min_points` voxels of the cloud (itself included) within `radius_voxels` is a core; cores
/// within the radius of each other share a cluster, other voxels near a core join the first cluster that reaches them,
/// the rest is noise. Distances count voxels along each axis. All memory is taken by the constructor; one thread at a
/// time.
class Dbscan {
 public:
  Dbscan(const VoxelGrid& grid, std::size_t max_voxels, double radius_voxels, std::size_t min_points);

  /// Cluster of each voxel of the cloud, from 0 in order of their first core; kNoise. Valid until the next call.
  const std::vector<std::int32_t>& label(const VoxelCloud& cloud) noexcept;

  /// Appends the average position of each cluster to `candidates` (up to its capacity); returns how many did not fit.
  std::size_t classify(const RayCounter& counter, const VoxelCloud& cloud, std::vector<Candidate>& candidates) noexcept;

  static constexpr std::int32_t kNoise = -1;

 private:
  struct Centre {
    double x = 0, y = 0, z = 0, n = 0;
  };
  std::size_t find_neighbours(const VoxelCloud& cloud, std::size_t voxel) noexcept;
  std::size_t place(std::int32_t x, std::int32_t y, std::int32_t z) const noexcept;
  void grow(const VoxelCloud& cloud, std::int32_t cluster) noexcept;

  const VoxelGrid grid_;
  const std::size_t min_points_;
  std::vector<std::array<std::int32_t, 3>> ball_;  // offsets within the radius
  std::vector<std::uint32_t> voxel_at_;            // position in the cloud + 1 of each voxel of the volume; 0: none
  std::vector<std::uint32_t> neighbours_, queue_;
  std::vector<std::int32_t> labels_;
  std::vector<Centre> centres_;
  std::int32_t clusters_ = 0;
};

}  // namespace rptv
