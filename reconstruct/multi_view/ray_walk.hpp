// SPDX-License-Identifier: MIT
// Follows rays of one view from view to view, depth first, and solves the sets of detections on the way: one thread's
// part of the matching.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/instruction_set.hpp"
#include "reconstruct/multi_view/asked_place_kernel.hpp"
#include "reconstruct/multi_view/epipolar_pencil.hpp"
#include "reconstruct/multi_view/tuple_solver.hpp"
#include "reconstruct/multi_view/view_match.hpp"

namespace rptv {

/// What all walks of a frame read, and none writes.
struct WalkedViews {
  std::span<const SeenView> views;
  std::span<const std::vector<std::uint8_t>> settled;  ///< by view and detection: 1 for those to leave alone
  Point3 half_mm;                                      ///< half edges of the volume
  std::size_t min_views;
  double tolerance_px;
};

/// Rays of detections `from` to `until` of view `first`, by what view `second` saw near them.
struct RayStretch {
  std::size_t first, second;
  const EpipolarPencil* pencil;  ///< of `second` by the lines of `first`; null: its strips are asked
  std::size_t from, until;
};

struct WalkCounts {
  std::uint64_t work = 0;  ///< steps of some 10 ns
  std::uint64_t unsearched = 0, refused_hits = 0;
  std::size_t rays = 0, pairs = 0, tuples = 0;
};

/// Takes the sets that meet within the volume, in the order in which they are found.
class MatchSink {
 public:
  virtual ~MatchSink() = default;
  /// False: it has no room, and the walk had better end.
  virtual bool take(const ViewMatch& match) noexcept = 0;
};

/// One thread at a time; what it finds in a stretch does not depend on what it did before. Allocates nothing.
class alignas(64) RayWalk {
 public:
  RayWalk(std::span<const SeenView> views, double scale_mm, InstructionSet set);

  /// Ends early, and says false, when the sink has no room. Rays are not followed once `most_work` steps are done.
  bool walk(const WalkedViews& seen, const RayStretch& stretch, std::uint64_t most_work, MatchSink& sink,
            WalkCounts& counts) noexcept;
  /// Solves these sets, and parts of those that do not meet.
  void judge(const WalkedViews& seen, std::span<const ViewTuple> tuples, MatchSink& sink, WalkCounts& counts) noexcept;

 private:
  struct Seed;
  void begin(const WalkedViews& seen, MatchSink& sink, WalkCounts& counts) noexcept;
  void follow(const RayStretch& stretch, std::size_t detection) noexcept;
  bool meets(Seed& seed, std::size_t view, std::uint32_t detection, double error_px) const noexcept;
  void extend(const Seed& seed, ViewTuple& tuple, std::size_t view) noexcept;
  const EpipolarLine& line_in(std::size_t view, const Sight& sight) noexcept;
  std::size_t ask(const Seed& seed, std::size_t view, std::array<std::uint32_t, kMostHits>& hit) noexcept;
  void propose(const ViewTuple& tuple) noexcept;
  void solve(bool all) noexcept;
  void accept(const ViewMatch& match) noexcept;

  TupleSolver solver_;
  std::vector<ViewTuple> doubtful_;           ///< sets to try that are parts of sets that do not meet
  std::array<EpipolarLine, kMaxViews> line_;  ///< of the ray that is followed, in the views of `lined_`
  std::uint32_t lined_ = 0;
  const WalkedViews* seen_ = nullptr;
  MatchSink* sink_ = nullptr;
  WalkCounts* counts_ = nullptr;
  bool room_ = true;
};

}  // namespace rptv
