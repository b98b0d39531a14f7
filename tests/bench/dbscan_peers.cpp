// SPDX-License-Identifier: MIT
// The peers of reconstruct/light_field/classify_dbscan.
#include "tests/bench/dbscan_peers.hpp"

#include <algorithm>
#include <array>
#include <nanoflann.hpp>

namespace rptv::bench {

std::size_t Labelling::noise() const { return static_cast<std::size_t>(std::count(label.begin(), label.end(), -1)); }

IndexVolumeDbscan::IndexVolumeDbscan(const VoxelGrid& grid)
    : grid_(grid), index_(static_cast<std::size_t>(grid.plane_size()) * (static_cast<std::size_t>(grid.planes) + 2)) {
  for (std::int64_t z = -1; z <= 1; ++z)
    for (std::int64_t y = -1; y <= 1; ++y)
      for (std::int64_t x = -1; x <= 1; ++x) offsets_.push_back(z * grid.plane_size() + y * grid.stride() + x);
}

std::size_t IndexVolumeDbscan::place(const CloudVoxel& v) const {
  return static_cast<std::size_t>((v.z + 1) * grid_.plane_size() + grid_.index(v.x, v.y));
}

void IndexVolumeDbscan::run(const std::vector<CloudVoxel>& voxels, std::size_t min_points, Labelling& out) {
  const auto neighbour = [&](std::size_t at, std::int64_t offset) {
    return index_[static_cast<std::size_t>(static_cast<std::int64_t>(at) + offset)];
  };
  const auto root = [&](std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  };
  core_.resize(voxels.size()), parent_.resize(voxels.size()), out.label.resize(voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) index_[place(voxels[i])] = static_cast<std::uint32_t>(i + 1);
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    std::size_t count = 0;
    for (const auto offset : offsets_) count += neighbour(place(voxels[i]), offset) != 0;
    core_[i] = count >= min_points, parent_[i] = static_cast<std::uint32_t>(i);
  }
  for (std::size_t i = 0; i < voxels.size(); ++i)
    for (std::size_t k = 0; core_[i] != 0 && k < offsets_.size() / 2; ++k)
      if (const auto other = neighbour(place(voxels[i]), offsets_[k]); other != 0 && core_[other - 1] != 0) {
        const auto a = root(static_cast<std::uint32_t>(i)), b = root(other - 1);
        parent_[std::max(a, b)] = std::min(a, b);
      }
  out.clusters = 0;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const auto top = root(static_cast<std::uint32_t>(i));
    out.label[i] = core_[i] == 0 ? -1 : top == i ? out.clusters++ : out.label[top];
  }
  for (std::size_t i = 0; i < voxels.size(); ++i)
    for (std::size_t k = 0; core_[i] == 0 && out.label[i] < 0 && k < offsets_.size(); ++k)
      if (const auto other = neighbour(place(voxels[i]), offsets_[k]); other != 0 && core_[other - 1] != 0)
        out.label[i] = out.label[other - 1];
  for (const auto& voxel : voxels) index_[place(voxel)] = 0;
}

namespace {
struct Points {
  const std::vector<CloudVoxel>& voxels;
  std::size_t kdtree_get_point_count() const { return voxels.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    const auto& v = voxels[i];
    return static_cast<float>(axis == 0 ? v.x : axis == 1 ? v.y : v.z);
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
}  // namespace

void kd_tree_dbscan(const std::vector<CloudVoxel>& voxels, double radius, std::size_t min_points, Labelling& out) {
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points>, Points, 3, std::size_t>;
  const Points points{voxels};
  const Tree tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  std::vector<std::pair<std::size_t, float>> near;
  const auto search = [&](std::size_t i) {
    const std::array<float, 3> at{points.kdtree_get_pt(i, 0), points.kdtree_get_pt(i, 1), points.kdtree_get_pt(i, 2)};
    nanoflann::SearchParams unsorted;
    unsorted.sorted = false;
    return tree.radiusSearch(at.data(), static_cast<float>(radius * radius), near, unsorted);
  };
  constexpr std::int32_t kUnseen = -2;
  out.label.assign(voxels.size(), kUnseen), out.clusters = 0;
  std::vector<std::size_t> queue;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    if (out.label[i] != kUnseen) continue;
    out.label[i] = -1;
    if (search(i) < min_points) continue;
    const std::int32_t cluster = out.clusters++;
    queue.assign(1, i), out.label[i] = cluster;
    for (std::size_t next = 0; next < queue.size(); ++next) {
      if (search(queue[next]) < min_points) continue;
      for (const auto& [other, distance] : near) {
        if (out.label[other] == kUnseen) queue.push_back(other);
        if (out.label[other] < 0) out.label[other] = cluster;
      }
    }
  }
}

}  // namespace rptv::bench
