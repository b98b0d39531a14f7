// SPDX-License-Identifier: MIT
// Which detections of 2 to 16 views may be one particle: every set of at least min_views whose rays meet in the volume.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/instruction_set.hpp"
#include "reconstruct/multi_view/epipolar_pencil.hpp"
#include "reconstruct/multi_view/ray_walk.hpp"
#include "reconstruct/multi_view/walks_ahead.hpp"

namespace rptv {

struct CorrespondenceOptions {
  std::size_t min_views = 3;
  double tolerance_px = 1;             ///< largest reprojection error, in every view
  std::size_t max_detections = 16384;  ///< of a view
  std::size_t max_matches = 65536;     ///< before ghosts are removed
  std::size_t threads = 1;             ///< that share the work; the result does not depend on it
};

/// Since construction, except where stated.
struct CorrespondenceCounts {
  std::uint64_t unusable_detections = 0;  ///< beyond the image, no light from the volume, or beyond max_detections
  std::uint64_t unsearched = 0;           ///< detections whose ray was not followed: the frame's work was used up
  std::uint64_t refused_hits = 0;         ///< detections near one place beyond the first eight
  std::uint64_t refused_matches = 0;      ///< beyond max_matches
  std::size_t rays = 0, pairs = 0, tuples = 0;  ///< of the last frame: followed (once a view), near them, solved
};

/// A ray of the first view is followed through the images of the later ones; what is near it fixes a depth, and the
/// other views are asked at that depth. Sets that do not meet are tried without views. A set within a set that meets is
/// not listed. A set of all views (or of kEnoughViews) whose rms error is within half the tolerance settles its
/// detections: later pairs of views leave them alone. Rays are followed in stretches, by several threads at once and
/// ahead of the list, which takes up what they found in the order of the stretches. One caller at a time; match()
/// allocates nothing, and its time is bounded by 3·kWorkPerMatch · max_matches steps of some 10 ns.
class Correspondence {
 public:
  static constexpr std::uint64_t kWorkPerMatch = 64;

  /// `views` must outlive this. Throws Error(configuration) when there are fewer than min_views, or not 2 to 16.
  Correspondence(std::span<const ViewRays> views, const Volume& volume, const CorrespondenceOptions& options,
                 InstructionSet set = best_instruction_set());

  /// From now on: sets of at least `min_views` views (2 to all), within `tolerance_px`.
  void demand(std::size_t min_views, double tolerance_px) noexcept {
    options_.min_views = min_views, options_.tolerance_px = tolerance_px;
  }

  /// Takes what one view saw. Different views at once, each by any thread; then match().
  void look(std::size_t view, const Detections& seen) noexcept;
  /// Of what every view saw. Valid until the next look(), as views().
  std::span<const ViewMatch> match() noexcept;
  /// Both, of one list per view.
  std::span<const ViewMatch> match(std::span<const Detections> seen) noexcept;

  /// Tries tuples that the caller made of detections of the last match(), also when they are within listed ones; those
  /// that meet are added behind the list, and returned.
  std::span<const ViewMatch> add(std::span<const ViewTuple> tuples) noexcept;
  std::size_t size() const noexcept { return matches_.size(); }

  std::span<const SeenView> views() const noexcept { return views_; }
  const CorrespondenceOptions& options() const noexcept { return options_; }
  const CorrespondenceCounts& counts() const noexcept { return counts_; }

 private:
  /// The list, which refuses what it has or has no room for.
  struct List final : MatchSink {
    explicit List(Correspondence& owner) : of(owner) {}
    bool take(const ViewMatch& match) noexcept override;
    Correspondence& of;
  };
  WalkedViews walked() const noexcept;
  void search(std::size_t first, std::size_t second) noexcept;
  void count(const WalkCounts& counts) noexcept;
  void settle(std::size_t first_match) noexcept;
  bool listed(const ViewTuple& tuple) const noexcept;

  CorrespondenceOptions options_;
  Point3 half_mm_;
  std::vector<SeenView> views_;
  std::array<std::array<PencilOfLines, kMaxViews>, kMaxViews> lines_;  ///< of a view in another
  EpipolarPencil pencil_;
  RayWalk walk_;
  WalksAhead ahead_;
  std::vector<ViewMatch> matches_;
  std::array<std::vector<std::uint32_t>, kMaxViews> first_match_;  ///< of each detection, or kUnseen
  std::array<std::vector<std::uint8_t>, kMaxViews> settled_;       ///< by detection
  std::array<std::size_t, kMaxViews> unusable_{};                  ///< detections of the last look()
  std::vector<std::array<std::uint32_t, kMaxViews>> next_match_;   ///< of the same detection, or kUnseen
  std::uint64_t work_ = 0;
  CorrespondenceCounts counts_;
};

}  // namespace rptv
