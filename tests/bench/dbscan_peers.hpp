// SPDX-License-Identifier: MIT
// Two other ways to do DBSCAN of voxels: with a volume of indices, and with a k-d tree.
#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/light_field/voxel_cloud.hpp"

namespace rptv::bench {

/// Clusters and noise of one labelling; labels themselves may be numbered differently.
struct Labelling {
  std::vector<std::int32_t> label;  ///< -1: noise
  std::int32_t clusters = 0;
  std::size_t noise() const;
};

/// 26 neighbours counted in a dense volume of indices, cores joined by union-find, border voxels by their first core.
class IndexVolumeDbscan {
 public:
  explicit IndexVolumeDbscan(const VoxelGrid& grid);
  void run(const std::vector<CloudVoxel>& voxels, std::size_t min_points, Labelling& out);

 private:
  std::size_t place(const CloudVoxel& voxel) const;
  const VoxelGrid grid_;
  std::vector<std::int64_t> offsets_;
  std::vector<std::uint32_t> index_;  // + 1; a border of one plane at either end
  std::vector<char> core_;
  std::vector<std::uint32_t> parent_;
};

/// Textbook DBSCAN on nanoflann's radius search.
void kd_tree_dbscan(const std::vector<CloudVoxel>& voxels, double radius_voxels, std::size_t min_points,
                    Labelling& out);

}  // namespace rptv::bench
