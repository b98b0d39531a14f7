// SPDX-License-Identifier: MIT
// Fixed-lag smoothing: what frames to come say about where particles were, for files that may wait.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

#include "core/tracks.hpp"
#include "tracking/kalman.hpp"
#include "tracking/linker.hpp"

namespace rptv {

/// One frame, `lag` frames late.
struct SmoothedFrame {
  std::uint64_t frame = 0;
  double t_s = 0;
  Tracks tracks;
};

/// Rauch, Tung & Striebel, AIAA J. 3 (1965) 1445, over the last `lag` frames: every row is given back when `lag` later
/// frames are known, with the position, velocity, acceleration and covariances that all of them together imply. A
/// track is smoothed across frames in which it was unseen, and not across faults of the clock. Allocates: for batch
/// commands and recordings, not for the live path. One thread.
class FixedLagSmoother {
 public:
  explicit FixedLagSmoother(std::size_t lag_frames) : lag_(lag_frames) {}

  /// Right after linker.next(…, tracks), for every frame. Throws Error(configuration) unless the linker filters.
  void push(const Linker& linker, std::uint64_t frame, double t_s, const Tracks& tracks);
  /// The oldest frame, if `lag` later ones were pushed, or any with `at_end`; false when there is none.
  bool pop(SmoothedFrame& out, bool at_end = false);

 private:
  struct Step {  // a row's continuation
    std::uint64_t sequence = 0;
    std::size_t row = 0;
  };
  struct Row {
    KalmanState state;
    Step next{};
    bool continues = false;
  };
  struct Frame {
    SmoothedFrame content;
    KalmanModel model;
    std::vector<Row> rows;
  };
  Frame& at(std::uint64_t sequence) { return frames_[static_cast<std::size_t>(sequence - first_)]; }
  KalmanState smoothed(std::size_t row);

  std::size_t lag_;
  std::deque<Frame> frames_;
  std::uint64_t first_ = 0;  // sequence number of frames_.front()
  std::uint64_t clock_faults_ = 0;
  std::unordered_map<std::uint64_t, Step> last_;  // where each track was last
  std::vector<Step> path_;
};

}  // namespace rptv
