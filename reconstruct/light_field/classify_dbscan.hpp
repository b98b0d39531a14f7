// SPDX-License-Identifier: MIT
// Sparse clouds: voxels are clustered by density (DBSCAN, Ester et al. 1996) and each cluster's centre is a candidate.
#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/light_field/voxel_cloud.hpp"

namespace rptv {

/// A voxel with at least `min_points` voxels of the cloud (itself included) within `radius_voxels` is a core; cores
/// within the radius of each other share a cluster, other voxels near a core join the first cluster that reaches them,
/// the rest is noise. Distances count voxels along each axis. On a grid the neighbourhood is a stack of rows:
/// neighbours are counted in rows of bits, and runs of cores, not voxels, are joined (union-find). All memory is taken
/// by the constructor; one thread at a time.
class Dbscan {
 public:
  /// `radius_voxels` is 1 to 16.
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
  /// Neighbours of (x, y, z) on row (y + dy, z + dz): x - reach … x + reach.
  struct BallRow {
    std::int32_t dy, dz, reach;
  };
  /// Cores side by side on one row.
  struct Run {
    std::int32_t first_x, last_x;
    std::uint32_t parent;  ///< of a joined run: one before it; the first run of a cluster is its own parent
    std::int32_t cluster;
  };
  /// Voxels of the cloud that lie on one row.
  struct CloudRow {
    std::int32_t y, z;
    std::size_t first, last, first_run, last_run;
    bool all_cores;
  };

  /// A row of the cloud within the ball round another one.
  struct NearRow {
    const std::uint8_t* bits;
    std::size_t run, last_run;
    std::int32_t reach;
  };

  std::size_t row_number(std::int32_t y, std::int32_t z) const noexcept;
  void split_into_rows(const std::vector<CloudVoxel>& voxels) noexcept;
  void find_near_rows(const CloudRow& row, const std::vector<std::uint8_t>& bits) noexcept;
  void find_cores(const std::vector<CloudVoxel>& voxels, const CloudRow& row) noexcept;
  void find_runs(const std::vector<CloudVoxel>& voxels, CloudRow& row) noexcept;
  void join_runs(const CloudRow& row) noexcept;
  std::uint32_t root_of(std::uint32_t run) noexcept;
  void join(std::uint32_t one, std::uint32_t other) noexcept;
  void number_clusters() noexcept;
  void label_cores(const std::vector<CloudVoxel>& voxels, const CloudRow& row) noexcept;
  void label_borders(const std::vector<CloudVoxel>& voxels, const CloudRow& row) noexcept;

  const VoxelGrid grid_;
  const std::size_t min_points_, row_bytes_;
  std::vector<BallRow> ball_;
  std::vector<std::uint32_t> cloud_row_at_;  // number in rows_ + 1 of each row of the volume; 0: none
  std::vector<CloudRow> rows_;
  std::vector<std::uint8_t> bits_, core_bits_;  // of each of rows_: its voxels, its cores; with room at both ends
  std::vector<NearRow> near_;
  std::vector<Run> runs_;
  std::vector<char> core_;  // of each voxel
  std::vector<std::int32_t> labels_;
  std::vector<Centre> centres_;
  std::int32_t clusters_ = 0;
};

}  // namespace rptv
