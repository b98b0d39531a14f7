// SPDX-License-Identifier: MIT
// Pairs the frames of several cameras into sets by trigger index: in order, with bounded memory, every loss counted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/frame.hpp"
#include "core/losses.hpp"

namespace rptv {

/// Holds a short queue of frames per camera and joins the queues at their heads. Each camera's indices strictly
/// increase (Intake sees to that), so a head that is older than another camera's head has lost its partner for good and
/// is given up at once (`set_incomplete`). Only when a camera has nothing at all to show is there something to wait
/// for: then the oldest index is kept until one camera has more than `patience` newer frames. A frame whose index was
/// already published or given up is dropped as `set_stale`. So each offered frame ends in one set or in one count.
///
/// One thread at a time. All memory is taken by the constructor.
class Bundler {
 public:
  /// `patience` of a bundler that never gives up by itself: see give_up_oldest().
  static constexpr std::size_t kForever = std::numeric_limits<std::size_t>::max();

  /// `room` ≥ 1 frames are held per camera; a finite `patience` needs room ≥ patience + 2. One Losses per camera; they
  /// must outlive this object.
  Bundler(std::vector<Losses*> losses, std::size_t room, std::size_t patience);

  bool has_room(std::size_t camera) const noexcept { return lanes_[camera].held < room_; }
  /// No frame of this camera is held.
  bool lacks(std::size_t camera) const noexcept { return lanes_[camera].held == 0; }
  std::size_t cameras() const noexcept { return lanes_.size(); }

  /// Requires has_room(frame.info.camera). Call take() until it is false before the next look at has_room().
  void offer(Frame&& frame) noexcept;

  /// The oldest complete set; false when there is none yet. Indices of successive sets strictly increase.
  bool take(FrameSet& set) noexcept;

  /// Drops the frames of the oldest index held, as `set_incomplete`; false when none is held. For callers that know
  /// that a partner will not come. Call it when take() says false.
  bool give_up_oldest() noexcept;

 private:
  // A queue in a circle of `room_` frames.
  struct Lane {
    std::vector<Frame> frames;
    std::size_t first = 0;
    std::size_t held = 0;
    Losses* losses = nullptr;
  };
  struct Heads {
    std::uint64_t oldest = std::numeric_limits<std::uint64_t>::max();
    std::uint64_t newest = 0;
    std::size_t present = 0;  ///< cameras that hold at least one frame
    std::size_t most_held = 0;
  };
  Heads heads() const noexcept;
  const Frame& head(const Lane& lane) const noexcept { return lane.frames[lane.first]; }
  Frame pop(Lane& lane) noexcept;
  void give_up(std::uint64_t index) noexcept;

  std::vector<Lane> lanes_;
  std::size_t room_;
  std::size_t patience_;
  std::uint64_t horizon_ = 0;  ///< every smaller index was published or given up
};

}  // namespace rptv
