// SPDX-License-Identifier: MIT
// DBSCAN on a grid: a neighbourhood is a fixed set of offsets.
#include "reconstruct/classify_dbscan.hpp"

#include <algorithm>
#include <cmath>

namespace rptv {

namespace {
constexpr std::int32_t kUnseen = -2;
}

Dbscan::Dbscan(const VoxelGrid& grid, std::size_t max_voxels, double radius_voxels, std::size_t min_points)
    : grid_(grid),
      min_points_(min_points),
      voxel_at_(static_cast<std::size_t>(grid.plane_size()) * static_cast<std::size_t>(grid.planes)) {
  const auto reach = static_cast<std::int32_t>(std::floor(radius_voxels));
  for (std::int32_t z = -reach; z <= reach; ++z)
    for (std::int32_t y = -reach; y <= reach; ++y)
      for (std::int32_t x = -reach; x <= reach; ++x)
        if (x * x + y * y + z * z <= radius_voxels * radius_voxels) ball_.push_back({x, y, z});
  neighbours_.resize(ball_.size());
  queue_.reserve(max_voxels);
  labels_.reserve(max_voxels);
  centres_.reserve(max_voxels);
}

std::size_t Dbscan::place(std::int32_t x, std::int32_t y, std::int32_t z) const noexcept {
  return static_cast<std::size_t>(z) * static_cast<std::size_t>(grid_.plane_size()) +
         static_cast<std::size_t>(grid_.index(x, y));
}

std::size_t Dbscan::find_neighbours(const VoxelCloud& cloud, std::size_t voxel) noexcept {
  const auto& v = cloud.voxels()[voxel];
  std::size_t count = 0;
  for (const auto& [dx, dy, dz] : ball_) {
    const std::int32_t x = v.x + dx, y = v.y + dy, z = v.z + dz;
    if (x < 1 || y < 1 || z < 0 || x > grid_.size_x || y > grid_.size_y || z >= grid_.planes) continue;
    if (const auto other = voxel_at_[place(x, y, z)]; other != 0) neighbours_[count++] = other - 1;
  }
  return count;
}

void Dbscan::grow(const VoxelCloud& cloud, std::int32_t cluster) noexcept {
  for (std::size_t next = 0; next < queue_.size(); ++next) {
    const std::size_t count = find_neighbours(cloud, queue_[next]);
    if (count < min_points_) continue;  // a border voxel: in the cluster, but does not extend it
    for (std::size_t k = 0; k < count; ++k) {
      auto& label = labels_[neighbours_[k]];
      if (label == kUnseen) queue_.push_back(neighbours_[k]);
      if (label < 0) label = cluster;
    }
  }
}

const std::vector<std::int32_t>& Dbscan::label(const VoxelCloud& cloud) noexcept {
  const auto& voxels = cloud.voxels();
  labels_.assign(voxels.size(), kUnseen);
  clusters_ = 0;
  for (std::size_t i = 0; i < voxels.size(); ++i)
    voxel_at_[place(voxels[i].x, voxels[i].y, voxels[i].z)] = static_cast<std::uint32_t>(i + 1);
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    if (labels_[i] != kUnseen) continue;
    if (find_neighbours(cloud, i) < min_points_) {
      labels_[i] = kNoise;  // unless a core claims it later
      continue;
    }
    labels_[i] = clusters_;
    queue_.clear();
    queue_.push_back(static_cast<std::uint32_t>(i));
    grow(cloud, clusters_++);
  }
  for (const auto& v : voxels) voxel_at_[place(v.x, v.y, v.z)] = 0;
  return labels_;
}

std::size_t Dbscan::classify(const RayCounter& counter, const VoxelCloud& cloud,
                             std::vector<Candidate>& candidates) noexcept {
  label(cloud);
  centres_.assign(static_cast<std::size_t>(clusters_), Centre{});
  for (std::size_t i = 0; i < labels_.size(); ++i) {
    if (labels_[i] < 0) continue;
    auto& centre = centres_[static_cast<std::size_t>(labels_[i])];
    const auto& v = cloud.voxels()[i];
    centre.x += v.x, centre.y += v.y, centre.z += v.z, centre.n += 1;
  }
  std::size_t refused = 0;
  for (const auto& centre : centres_) {
    if (candidates.size() == candidates.capacity())
      ++refused;
    else
      candidates.push_back(candidate_at(counter, centre.x / centre.n, centre.y / centre.n, centre.z / centre.n));
  }
  return refused;
}

}  // namespace rptv
