// SPDX-License-Identifier: MIT
// One frame set's way through the device: detections up, matches and the choice among them, particles' matches back.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reconstruct/multi_view/match_memory_cuda.hpp"
#include "reconstruct/multi_view/view_pairs_cuda.hpp"

namespace rptv {

/// What does not change, and is on the device once: the views' geometry, and which rays are followed where.
class MatchRig {
 public:
  /// `views` must outlive this. Throws Error(unavailable) where a view sees another's pinhole, which only the CPU's
  /// search can do, or the device has no room.
  /// `threads_per_block`: of the kernels, a multiple of 32.
  MatchRig(std::span<const ViewRays> views, const Volume& volume, const CorrespondenceOptions& options,
           unsigned threads_per_block = 128);

  std::size_t size() const noexcept { return views_.size(); }
  std::span<const ViewRays> views() const noexcept { return views_; }
  const CorrespondenceOptions& options() const noexcept { return options_; }
  const CudaViewGeometry* on_device() const noexcept { return device_.data(); }
  const CellOf& cell_of(std::size_t view) const noexcept { return geometry_[view].cell; }
  const CudaJudging& judging() const noexcept { return judging_; }
  unsigned threads_per_block() const noexcept { return threads_per_block_; }
  /// Search from `first` to `second` in what `views` holds.
  CudaPairSearch search(const CudaViews& views, std::size_t first, std::size_t second,
                        std::span<const std::uint32_t> counts) const noexcept;

 private:
  std::span<const ViewRays> views_;
  CorrespondenceOptions options_;
  std::vector<CudaViewGeometry> geometry_;
  std::array<std::array<PencilOfLines, kMaxViews>, kMaxViews> lines_;
  DeviceArray<CudaViewGeometry> device_;
  CudaJudging judging_;
  unsigned threads_per_block_;
};

/// Since construction, except where stated.
struct MatchStreamCounts {
  std::uint64_t unusable_detections = 0;                                  ///< as CorrespondenceCounts
  std::uint64_t refused_hits = 0, refused_pairs = 0, refused_tuples = 0;  ///< as CudaMatchCounts
  std::uint64_t refused_matches = 0;                                      ///< beyond max_matches
  std::size_t rays = 0, pairs = 0;                                        ///< of the last frame set
  std::uint64_t failed = 0;  ///< frame sets that the device refused; take_cuda_error() says why
};

/// A stream with memory of its own. One thread; after construction nothing is allocated and nothing thrown.
class MatchStream {
 public:
  /// `rig` must outlive this. Throws Error(unavailable) when the device has no room.
  explicit MatchStream(const MatchRig& rig);

  /// Queues a frame set, one list per view; returns while the device works. The last one has been collected.
  void submit(std::span<const Detections> seen) noexcept;
  /// Waits for it: the chosen matches in order of their detections, with the bits of the CPU backend. Valid until the
  /// next submit(), as views().
  std::span<const ViewMatch> collect() noexcept;

  std::span<const SeenView> views() const noexcept { return views_; }
  const MatchStreamCounts& counts() const noexcept { return counts_; }

 private:
  CudaViews device_views() const noexcept;
  CudaMatches device_matches() const noexcept;
  bool upload() noexcept;
  bool search() noexcept;
  bool solve() noexcept;
  bool choose() noexcept;
  bool download() noexcept;

  const MatchRig& rig_;
  std::vector<SeenView> views_;
  MatchMemory memory_;
  MatchTransfer transfer_;
  CudaStream stream_;
  std::array<std::uint32_t, kMaxViews> sizes_{};
  std::vector<ViewMatch> chosen_;
  bool queued_ = false;
  MatchStreamCounts counts_;
};

}  // namespace rptv
