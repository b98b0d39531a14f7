// SPDX-License-Identifier: MIT
// Joins the frames of several cameras into sets: in order, with bounded memory and waiting, every loss counted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "acquisition/pairing.hpp"
#include "acquisition/skew_meter.hpp"
#include "core/frame.hpp"
#include "core/losses.hpp"

namespace rptv {

struct BundlerOptions {
  static constexpr std::size_t kForever = std::numeric_limits<std::size_t>::max();
  static constexpr std::int64_t kNoBound = std::numeric_limits<std::int64_t>::max();
  std::size_t room = 6;              ///< frames held per camera, ≥ 1; a finite patience needs room ≥ patience + 2
  std::size_t patience = 4;          ///< newer frames that a camera may hold while its oldest one waits
  std::int64_t bound_ns = kNoBound;  ///< an incomplete set waits no longer
  PairingOptions pairing = {};
};

/// Holds a short queue of frames per camera and joins the queues at their heads. Each camera's frames come in order
/// (Intake sees to that), so a head that Pairing finds older than another camera's head has lost its partner for good
/// and is given up at once (`set_incomplete`, or `set_skew` when its index fitted and its time did not). Only when a
/// camera has nothing at all to show is there something to wait for: until one camera has more than `patience` newer
/// frames, or the first frame of the set has waited for `bound_ns`. By index alone, a frame whose index was already
/// published or given up is dropped as `set_stale`; in PTP time, one without such a time as `set_untimed`. So each
/// offered frame ends in one set or in one count.
///
/// One thread at a time, skew() excepted. All memory is taken by the constructor. `now_ns`: of any clock that does not
/// run backwards.
class Bundler {
 public:
  /// One Losses per camera; they must outlive this object.
  Bundler(std::vector<Losses*> losses, const BundlerOptions& options);

  bool has_room(std::size_t camera) const noexcept { return lanes_[camera].held < options_.room; }
  /// No frame of this camera is held.
  bool lacks(std::size_t camera) const noexcept { return lanes_[camera].held == 0; }
  std::size_t cameras() const noexcept { return lanes_.size(); }

  /// Requires has_room(frame.info.camera). Call take() until it is false before the next look at has_room().
  void offer(Frame&& frame, std::int64_t now_ns) noexcept;

  /// The oldest complete set; false when there is none yet. Indices of successive sets strictly increase; all frames
  /// of a set get the index of the first camera's.
  bool take(FrameSet& set, std::int64_t now_ns) noexcept;

  /// Drops the oldest frame held of each camera, as `set_incomplete`; false when none is held. For callers that know
  /// that a partner will not come. Call it when take() says false: those frames are of one instant.
  bool give_up_oldest() noexcept;

  /// When take() has something to do even if no frame comes: at the end of the oldest set's bound.
  std::int64_t deadline_ns() const noexcept;

  /// Any thread: how far the camera's times lie from the first camera's in the sets so far.
  ClockSkew skew(std::size_t camera) const noexcept { return skews_[camera].skew(); }

 private:
  struct Waiting {
    Frame frame;
    std::int64_t since_ns = 0;
  };
  // A queue in a circle of `room` frames.
  struct Lane {
    std::vector<Waiting> frames;
    std::size_t first = 0;
    std::size_t held = 0;
    Losses* losses = nullptr;
  };
  const Waiting& head(const Lane& lane) const noexcept { return lane.frames[lane.first]; }
  Pairing::Heads heads() const noexcept;
  bool is_complete() const noexcept;
  bool has_waited_enough(std::int64_t now_ns) const noexcept;
  Frame pop(Lane& lane) noexcept;
  void drop(const Pairing::Passed& passed) noexcept;
  void fill(FrameSet& set) noexcept;

  const BundlerOptions options_;
  std::vector<Lane> lanes_;
  std::unique_ptr<SkewMeter[]> skews_;
  Pairing pairing_;
  std::uint64_t horizon_ = 0;  ///< by index alone: every smaller index was published or given up
};

}  // namespace rptv
