// SPDX-License-Identifier: MIT
// Loops of the ray counter over groups of planes, which threads share.
#include <algorithm>
#include <utility>

#include "reconstruct/light_field/ray_counter.hpp"
#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {
constexpr std::size_t kSumBlock = 512;  // counters; a block of all planes of a group stays in the first-level cache
constexpr std::size_t kMostCount = 65535;
constexpr std::size_t kGroupBytes = 1 << 20;  // a group of planes should stay in the second-level cache, but the first
constexpr std::size_t kLeastPlanes = 8;       // plane of each is the dearest: at least this many

std::size_t planes_in_group(std::size_t plane_size, std::size_t planes, std::size_t threads) noexcept {
  const std::size_t share = (planes + threads - 1) / threads;
  const std::size_t in_cache = kGroupBytes / (plane_size * sizeof(std::uint16_t));
  return std::clamp<std::size_t>(share, 1, std::clamp(in_cache, kLeastPlanes, VoxelChanges::kPlanes));
}
}  // namespace

RayCounter::RayCounter(const VoxelGrid& grid, std::size_t max_rays, std::size_t threads, InstructionSet set)
    : grid_(grid),
      plane_size_(static_cast<std::size_t>(grid.plane_size())),
      plane_words_((plane_size_ + 63) / 64),
      group_planes_(
          planes_in_group(plane_size_, static_cast<std::size_t>(grid.planes), std::max<std::size_t>(threads, 1))),
      loops_(ray_count_loops(set)),
      ray_memory_(4 * (max_rays + VoxelRays::kLanes)),
      counts_(plane_size_ * static_cast<std::size_t>(grid.planes)),
      marks_(plane_words_ * static_cast<std::size_t>(grid.planes)),
      changes_(std::max<std::size_t>(threads, 1)) {
  float* memory = ray_memory_.data();
  for (float** column : {&rays_.column, &rays_.row, &rays_.column_slope, &rays_.row_slope})
    *column = std::exchange(memory, memory + max_rays + VoxelRays::kLanes);
  rays_.size = 0;
}

void RayCounter::count(const Rays& rays, std::span<const std::uint8_t> taken, std::uint16_t least) noexcept {
  loops_.load(grid_, rays.all(), taken, rays_);
  const auto planes = static_cast<std::size_t>(grid_.planes);
  const std::size_t groups = (planes + group_planes_ - 1) / group_planes_;
  parallel_for(groups, changes_.size(),
               [&](std::size_t group, std::size_t thread) { count_group(group, changes_[thread], least); });
}

void RayCounter::count_group(std::size_t group, VoxelChanges& changes, std::uint16_t least) noexcept {
  const std::size_t first_plane = group * group_planes_;
  const std::size_t planes = std::min(group_planes_, static_cast<std::size_t>(grid_.planes) - first_plane);
  std::uint16_t* counts = counts_.data() + first_plane * plane_size_;
  std::fill_n(counts, planes * plane_size_, std::uint16_t{0});
  // Either is right; a move costs two steps, so that beyond half a move a plane it is cheaper to count afresh.
  const bool by_changes = !(rays_.slope_sum * grid_.step_z_mm > 0.5F * static_cast<float>(rays_.size));
  for (std::size_t first = 0; first < rays_.size; first += VoxelChanges::kRays) {
    const std::size_t last = std::min(first + VoxelChanges::kRays, rays_.size);
    const auto plane = static_cast<std::int32_t>(first_plane);
    (by_changes ? loops_.find_changes : loops_.find_voxels)(grid_, rays_, first, last, plane, planes, changes);
    by_changes ? add_changes(changes, last - first, planes, counts) : add_voxels(changes, last - first, planes, counts);
  }
  sum_group(first_plane, planes, least, by_changes);
}

// After it, planes beyond the first hold differences to the plane before, modulo 2^16.
void RayCounter::add_changes(const VoxelChanges& changes, std::size_t rays, std::size_t planes,
                             std::uint16_t* counts) const noexcept {
  for (std::size_t i = 0; i < rays; ++i) ++counts[changes.first[i]];
  for (std::size_t p = 1; p < planes; ++p) {
    counts += plane_size_;
    for (std::size_t i = 0; i < changes.count[p]; ++i) --counts[changes.from[p][i]], ++counts[changes.to[p][i]];
  }
}

// Four planes in turn: neighbouring rays meet in a voxel, and a counter cannot be read again just after it was written.
void RayCounter::add_voxels(const VoxelChanges& changes, std::size_t rays, std::size_t planes,
                            std::uint16_t* counts) const noexcept {
  std::size_t p = 0;
  for (; p + 4 <= planes; p += 4, counts += 4 * plane_size_) {
    const auto* to = &changes.to[p];
    std::uint16_t *second = counts + plane_size_, *third = second + plane_size_, *fourth = third + plane_size_;
    for (std::size_t i = 0; i < rays; ++i)
      ++counts[to[0][i]], ++second[to[1][i]], ++third[to[2][i]], ++fourth[to[3][i]];
  }
  for (; p < planes; ++p, counts += plane_size_)
    for (std::size_t i = 0; i < rays; ++i) ++counts[changes.to[p][i]];
}

// Every ray is in one voxel of each plane, border included: a plane whose counters do not add up has one that wrapped.
void RayCounter::sum_group(std::size_t first_plane, std::size_t planes, std::uint16_t least,
                           bool differences) noexcept {
  std::array<std::size_t, VoxelChanges::kPlanes> sums{};
  std::uint16_t* counts = counts_.data() + first_plane * plane_size_;
  for (std::size_t at = 0; at < plane_size_; at += kSumBlock) {
    const std::size_t size = std::min(kSumBlock, plane_size_ - at);
    for (std::size_t p = 0; p < planes; ++p) {
      std::uint16_t* block = counts + p * plane_size_ + at;
      sums[p] += loops_.sum_and_mark(block, differences && p > 0 ? block - plane_size_ : nullptr, size, least,
                                     &marks_[(first_plane + p) * plane_words_ + at / 64]);
    }
  }
  for (std::size_t p = 0; p < planes; ++p)
    if (sums[p] != rays_.size) count_saturating(first_plane + p, least);
}

void RayCounter::count_saturating(std::size_t plane, std::uint16_t least) noexcept {
  std::uint16_t* counts = counts_.data() + plane * plane_size_;
  std::fill_n(counts, plane_size_, std::uint16_t{0});
  const float z_mm = grid_.z_mm(static_cast<std::int32_t>(plane));
  for (std::size_t i = 0; i < rays_.size; ++i) {
    auto& counter =
        counts[voxel_of(grid_, {rays_.column[i], rays_.row[i], rays_.column_slope[i], rays_.row_slope[i]}, z_mm)];
    counter = static_cast<std::uint16_t>(counter + (counter != kMostCount));
  }
  loops_.sum_and_mark(counts, nullptr, plane_size_, least, &marks_[plane * plane_words_]);
}

}  // namespace rptv
