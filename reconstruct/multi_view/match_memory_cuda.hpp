// SPDX-License-Identifier: MIT
// The device memory that matching one frame set takes, all of it at set-up.
#pragma once

#include <algorithm>

#include "reconstruct/cuda_memory.hpp"
#include "reconstruct/multi_view/correspondence.hpp"
#include "reconstruct/multi_view/extend_pairs_cuda.hpp"
#include "reconstruct/multi_view/judge_tuples_cuda.hpp"
#include "reconstruct/multi_view/view_ghosts_cuda.hpp"

namespace rptv {

static_assert(kCudaMaxViews == kMaxViews && kNoDetection == kUnseen, "tuples mean the same on both sides");

/// A list of tuples.
struct TupleMemory {
  TupleMemory(std::size_t views, std::size_t capacity) : detection(views * capacity), count(1) {}
  CudaTuples view(std::size_t views) const noexcept {
    return {detection.data(), count.data(), static_cast<std::uint32_t>(detection.size() / views),
            static_cast<std::uint32_t>(views)};
  }
  DeviceArray<std::uint32_t> detection, count;
};

/// Throws Error(unavailable) when the device has no room.
struct MatchMemory {
  static constexpr std::size_t kPairsPerDetection = 16, kTuplesPerMatch = 4;

  MatchMemory(std::size_t views, const CorrespondenceOptions& options)
      : max_detections(options.max_detections),
        max_pairs(kPairsPerDetection * options.max_detections),
        max_tuples(kTuplesPerMatch * options.max_matches),
        max_matches(options.max_matches),
        ray(views * max_detections),
        u(ray.size()),
        v(ray.size()),
        rows(8 * ray.size()),
        settled(ray.size()),
        used(ray.size()),
        owner(ray.size()),
        cell_start(views * (CellOf::kCells + 2)),
        cell(ray.size()),
        cell_entry(ray.size()),
        bin_start(max_detections + 2),
        bin(max_detections),
        bin_entry(max_detections),
        pair_first(max_pairs),
        pair_second(max_pairs),
        pair_count(1),
        pair_depth_mm(max_pairs),
        hit(kMostHits * views * max_pairs),
        hits(views * max_pairs),
        tuples(views, max_tuples),
        doubtful(views, max_tuples),
        matches(views, max_matches),
        point(4 * max_tuples),
        match(5 * max_matches),
        chosen(max_matches),
        packed_count(1),
        packed(max_matches),
        counts(1) {}

  const std::size_t max_detections, max_pairs, max_tuples, max_matches;
  DeviceArray<SeenRay> ray;
  DeviceArray<double> u, v, rows;
  DeviceArray<std::uint32_t> settled, used, owner, cell_start, cell, cell_entry, bin_start, bin, bin_entry;
  DeviceArray<std::uint32_t> pair_first, pair_second, pair_count;
  DeviceArray<double> pair_depth_mm;
  DeviceArray<std::uint32_t> hit, hits;
  TupleMemory tuples, doubtful, matches;
  DeviceArray<double> point, match;
  DeviceArray<std::uint32_t> chosen, packed_count;
  DeviceArray<CudaChosen> packed;
  DeviceArray<CudaMatchCounts> counts;
};

/// What goes up, and comes back, of one frame set.
struct MatchTransfer {
  MatchTransfer(std::size_t views, const CorrespondenceOptions& options)
      : ray(views * options.max_detections),
        u(ray.size()),
        v(ray.size()),
        rows(ray.size()),
        found(1),
        packed(options.max_matches) {}

  PinnedArray<SeenRay> ray;
  PinnedArray<double> u, v;
  PinnedArray<DltRowPair> rows;
  struct Found {
    std::uint32_t chosen, matches;
    CudaMatchCounts counts;
  };
  PinnedArray<Found> found;
  PinnedArray<CudaChosen> packed;
};

}  // namespace rptv
