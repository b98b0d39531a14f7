// SPDX-License-Identifier: MIT
// The join of the cameras' queues at their heads.
#include "acquisition/bundler.hpp"

#include <algorithm>
#include <utility>

namespace rptv {

Bundler::Bundler(std::vector<Losses*> losses, std::size_t room, std::size_t patience)
    : lanes_(losses.size()), room_(room), patience_(patience) {
  for (std::size_t camera = 0; camera < lanes_.size(); ++camera) {
    lanes_[camera].frames = std::vector<Frame>(room);
    lanes_[camera].losses = losses[camera];
  }
}

void Bundler::offer(Frame&& frame) noexcept {
  Lane& lane = lanes_[frame.info.camera];
  if (frame.info.index < horizon_) {
    lane.losses->count(LossCause::set_stale);
    frame.lease.reset();
    return;
  }
  lane.frames[(lane.first + lane.held) % room_] = std::move(frame);
  ++lane.held;
}

bool Bundler::take(FrameSet& set) noexcept {
  while (true) {
    const Heads now = heads();
    if (now.present == 0) return false;
    if (now.oldest < now.newest) {
      give_up(now.oldest);  // another camera has already passed this index
    } else if (now.present == lanes_.size()) {
      break;
    } else if (now.most_held - 1 > patience_) {  // newer frames behind the head
      give_up(now.oldest);
    } else {
      return false;
    }
  }
  set.cameras = static_cast<std::uint32_t>(lanes_.size());
  for (std::size_t camera = 0; camera < lanes_.size(); ++camera) set.frames[camera] = pop(lanes_[camera]);
  horizon_ = set.info().index + 1;
  return true;
}

bool Bundler::give_up_oldest() noexcept {
  const Heads now = heads();
  if (now.present != 0) give_up(now.oldest);
  return now.present != 0;
}

Bundler::Heads Bundler::heads() const noexcept {
  Heads result;
  for (const Lane& lane : lanes_) {
    if (lane.held == 0) continue;
    const std::uint64_t index = head(lane).info.index;
    result.oldest = std::min(result.oldest, index);
    result.newest = std::max(result.newest, index);
    result.most_held = std::max(result.most_held, lane.held);
    ++result.present;
  }
  return result;
}

Frame Bundler::pop(Lane& lane) noexcept {
  Frame frame = std::move(lane.frames[lane.first]);
  lane.first = (lane.first + 1) % room_;
  --lane.held;
  return frame;
}

void Bundler::give_up(std::uint64_t index) noexcept {
  for (Lane& lane : lanes_) {
    if (lane.held == 0 || head(lane).info.index != index) continue;
    pop(lane);
    lane.losses->count(LossCause::set_incomplete);
  }
  horizon_ = std::max(horizon_, index + 1);
}

}  // namespace rptv
