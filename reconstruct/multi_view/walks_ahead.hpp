// SPDX-License-Identifier: MIT
// The rays of one pair of views followed by several threads at once, stretch by stretch, into memory of their own.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "reconstruct/multi_view/ray_walk.hpp"

namespace rptv {

/// What one thread found, in order. Threads write into them all the time: no two in one cache line.
struct alignas(64) FoundMatches final : MatchSink {
  explicit FoundMatches(std::size_t capacity) { list.reserve(capacity); }
  bool take(const ViewMatch& match) noexcept override {
    if (list.size() == list.capacity()) return false;
    list.push_back(match);
    return true;
  }
  std::vector<ViewMatch> list;
};

/// All memory is taken at construction. A stretch for which there was neither room nor work left is not whole: whoever
/// needs it walks it again.
class WalksAhead {
 public:
  static constexpr std::size_t kStretch = 64;  ///< rays

  struct Stretch {
    bool whole = false;
    WalkCounts counts;
    std::size_t thread = 0, from = 0, until = 0;  ///< of what that thread found
  };

  /// Room for `max_matches` in all threads together, and for stretches of `max_detections`.
  WalksAhead(std::span<const SeenView> views, double scale_mm, InstructionSet set, std::size_t threads,
             std::size_t max_detections, std::size_t max_matches);

  /// All rays of detections 0 to `rays` of view `first`; about `most_work` steps. Only stretches of these are valid
  /// afterwards, until the next call.
  void walk(const WalkedViews& seen, std::size_t first, std::size_t second, const EpipolarPencil* pencil,
            std::size_t rays, std::uint64_t most_work) noexcept;

  std::size_t threads() const noexcept { return walks_.size(); }
  const Stretch& stretch(std::size_t number) const noexcept { return stretches_[number]; }
  std::span<const ViewMatch> found(const Stretch& stretch) const noexcept {
    return std::span(found_[stretch.thread].list).subspan(stretch.from, stretch.until - stretch.from);
  }

 private:
  std::vector<RayWalk> walks_;
  std::vector<FoundMatches> found_;
  std::vector<Stretch> stretches_;
};

}  // namespace rptv
