// SPDX-License-Identifier: MIT
// DBSCAN on a grid: bits are counted, runs are joined.
#include "reconstruct/light_field/classify_dbscan.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace rptv {

namespace {

constexpr std::int32_t kMargin = 16;  // bits before the first voxel of a row: the largest radius
constexpr std::int32_t kUnseen = std::numeric_limits<std::int32_t>::max();

// Bits first … first + size - 1 of a row, size <= 33.
std::uint64_t bits_of(const std::uint8_t* row, std::int32_t first, std::int32_t size) noexcept {
  std::uint64_t eight_bytes = 0;
  std::memcpy(&eight_bytes, row + first / 8, sizeof eight_bytes);
  return eight_bytes >> (first % 8) & ((std::uint64_t{1} << size) - 1);
}

void set_bit(std::uint8_t* row, std::int32_t bit) noexcept {
  row[bit / 8] = static_cast<std::uint8_t>(row[bit / 8] | 1U << (bit % 8));
}

}  // namespace

Dbscan::Dbscan(const VoxelGrid& grid, std::size_t max_voxels, double radius_voxels, std::size_t min_points)
    : grid_(grid),
      min_points_(min_points),
      row_bytes_((static_cast<std::size_t>(grid.size_x) + 2 * kMargin) / 8 + sizeof(std::uint64_t)) {
  const auto reach = static_cast<std::int32_t>(std::floor(radius_voxels));
  for (std::int32_t dz = -reach; dz <= reach; ++dz)
    for (std::int32_t dy = -reach; dy <= reach; ++dy)
      if (const double left = radius_voxels * radius_voxels - dy * dy - dz * dz; left >= 0)
        ball_.push_back({dy, dz, static_cast<std::int32_t>(std::floor(std::sqrt(left)))});
  const auto rows = static_cast<std::size_t>(grid.size_y) * static_cast<std::size_t>(grid.planes);
  near_.reserve(ball_.size() + 1);
  cloud_row_at_.resize(rows);
  rows_.reserve(std::min(rows, max_voxels));
  bits_.resize(rows_.capacity() * row_bytes_);
  if (min_points > 1) core_bits_.resize(bits_.size());
  runs_.reserve(max_voxels);
  core_.reserve(max_voxels);
  labels_.reserve(max_voxels);
  centres_.reserve(max_voxels);
}

std::size_t Dbscan::row_number(std::int32_t y, std::int32_t z) const noexcept {
  return static_cast<std::size_t>(z) * static_cast<std::size_t>(grid_.size_y) + static_cast<std::size_t>(y - 1);
}

void Dbscan::split_into_rows(const std::vector<CloudVoxel>& voxels) noexcept {
  rows_.clear();
  for (std::size_t first = 0, last = 0; first < voxels.size(); first = last) {
    const std::int32_t y = voxels[first].y, z = voxels[first].z;
    std::uint8_t* bits = &bits_[rows_.size() * row_bytes_];
    std::fill_n(bits, row_bytes_, std::uint8_t{0});
    for (; last < voxels.size() && voxels[last].y == y && voxels[last].z == z; ++last)
      set_bit(bits, voxels[last].x + kMargin);
    rows_.push_back({y, z, first, last, 0, 0, true});
    cloud_row_at_[row_number(y, z)] = static_cast<std::uint32_t>(rows_.size());
  }
}

// In the order of ball_: those before the row itself first.
void Dbscan::find_near_rows(const CloudRow& row, const std::vector<std::uint8_t>& bits) noexcept {
  near_.clear();
  for (const auto& [dy, dz, reach] : ball_) {
    const std::int32_t y = row.y + dy, z = row.z + dz;
    if (y < 1 || z < 0 || y > grid_.size_y || z >= grid_.planes) continue;
    const std::uint32_t number = cloud_row_at_[row_number(y, z)];
    if (number == 0) continue;
    const CloudRow& other = rows_[number - 1];
    near_.push_back({bits.data() + (number - 1) * row_bytes_, other.first_run, other.last_run, reach});
  }
}

void Dbscan::find_cores(const std::vector<CloudVoxel>& voxels, const CloudRow& row) noexcept {
  for (std::size_t i = row.first; i < row.last; ++i) {
    std::uint64_t packed = 0;
    std::int32_t used = 0;
    std::size_t count = 0;
    for (const NearRow& near : near_) {
      const std::int32_t size = 2 * near.reach + 1;
      if (used + size > 64) count += static_cast<std::size_t>(std::popcount(std::exchange(packed, 0))), used = 0;
      packed |= bits_of(near.bits, voxels[i].x + kMargin - near.reach, size) << used;
      used += size;
    }
    core_[i] = count + static_cast<std::size_t>(std::popcount(packed)) >= min_points_;
  }
}

void Dbscan::find_runs(const std::vector<CloudVoxel>& voxels, CloudRow& row) noexcept {
  row.first_run = runs_.size();
  for (std::size_t i = row.first; i < row.last; ++i) {
    if (core_[i] == 0) {
      row.all_cores = false;
      continue;
    }
    const std::int32_t x = voxels[i].x;
    if (runs_.size() > row.first_run && runs_.back().last_x == x - 1)
      runs_.back().last_x = x;
    else
      runs_.push_back({x, x, static_cast<std::uint32_t>(runs_.size()), 0});
  }
  row.last_run = runs_.size();
  if (core_bits_.empty()) return;
  std::uint8_t* bits = &core_bits_[static_cast<std::size_t>(&row - rows_.data()) * row_bytes_];
  std::fill_n(bits, row_bytes_, std::uint8_t{0});
  for (std::size_t i = row.first; i < row.last; ++i)
    if (core_[i] != 0) set_bit(bits, voxels[i].x + kMargin);
}

std::uint32_t Dbscan::root_of(std::uint32_t run) noexcept {
  while (runs_[run].parent != run) run = runs_[run].parent = runs_[runs_[run].parent].parent;  // path halving
  return run;
}

void Dbscan::join(std::uint32_t one, std::uint32_t other) noexcept {
  if (runs_[one].parent == runs_[other].parent) return;  // mostly
  const std::uint32_t a = root_of(one), b = root_of(other);
  runs_[std::max(a, b)].parent = std::min(a, b);
}

// With the runs of this row and of rows before it (the others have none yet): two lists by rising x, side by side.
void Dbscan::join_runs(const CloudRow& row) noexcept {
  near_.push_back({nullptr, row.first_run, row.last_run, ball_[ball_.size() / 2].reach});
  for (const NearRow& near : near_) {
    std::size_t next = near.run;
    for (std::size_t run = row.first_run; run < row.last_run; ++run) {
      while (next < near.last_run && runs_[next].last_x + near.reach < runs_[run].first_x) ++next;
      for (std::size_t k = next; k < near.last_run && runs_[k].first_x <= runs_[run].last_x + near.reach; ++k)
        join(static_cast<std::uint32_t>(run), static_cast<std::uint32_t>(k));
    }
  }
}

void Dbscan::number_clusters() noexcept {
  clusters_ = 0;
  for (std::size_t run = 0; run < runs_.size(); ++run) {
    const std::uint32_t root = root_of(static_cast<std::uint32_t>(run));
    runs_[run].cluster = root == run ? clusters_++ : runs_[root].cluster;
  }
}

void Dbscan::label_cores(const std::vector<CloudVoxel>& voxels, const CloudRow& row) noexcept {
  std::size_t run = row.first_run;
  for (std::size_t i = row.first; i < row.last; ++i) {
    if (core_[i] == 0) continue;
    while (runs_[run].last_x < voxels[i].x) ++run;
    labels_[i] = runs_[run].cluster;
  }
}

// Clusters grow one after the other, so that the first to reach a voxel is the one with the lowest number.
void Dbscan::label_borders(const std::vector<CloudVoxel>& voxels, const CloudRow& row) noexcept {
  for (std::size_t i = row.first; i < row.last; ++i) {
    if (core_[i] != 0) continue;
    std::int32_t label = kUnseen;
    const std::int32_t x = voxels[i].x;
    for (NearRow& near : near_) {
      if (bits_of(near.bits, x + kMargin - near.reach, 2 * near.reach + 1) == 0) continue;
      while (runs_[near.run].last_x + near.reach < x) ++near.run;
      for (std::size_t k = near.run; k < near.last_run && runs_[k].first_x <= x + near.reach; ++k)
        label = std::min(label, runs_[k].cluster);
    }
    labels_[i] = label == kUnseen ? kNoise : label;
  }
}

const std::vector<std::int32_t>& Dbscan::label(const VoxelCloud& cloud) noexcept {
  const auto& voxels = cloud.voxels();
  labels_.resize(voxels.size());
  core_.assign(voxels.size(), 1);
  runs_.clear();
  split_into_rows(voxels);
  for (auto& row : rows_) {
    find_near_rows(row, bits_);
    if (min_points_ > 1) find_cores(voxels, row);
    find_runs(voxels, row);
    join_runs(row);
  }
  number_clusters();
  for (const auto& row : rows_) {
    label_cores(voxels, row);
    if (row.all_cores) continue;
    find_near_rows(row, core_bits_);
    label_borders(voxels, row);
  }
  for (const auto& row : rows_) cloud_row_at_[row_number(row.y, row.z)] = 0;  // for the next frame
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
