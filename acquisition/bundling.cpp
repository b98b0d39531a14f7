// SPDX-License-Identifier: MIT
// The Intake's bundling thread: carries frames from the cameras' lanes through the bundler into sets.
#include <algorithm>
#include <utility>

#include "acquisition/intake.hpp"
#include "acquisition/lane.hpp"
#include "core/clock.hpp"

namespace rptv {

void Intake::bundle() noexcept {
  constexpr std::int64_t kPatienceNs = 100'000'000;
  FrameSet set;
  std::int64_t stalled_since_ns = 0;
  while (true) {
    const std::uint32_t seen = arrived_.prepare();  // before the look: what arrives after it ends the wait
    const std::int64_t now_ns = host_now_ns();
    const bool moved = drain_all(now_ns);
    while (bundler_->take(set, now_ns)) publish(set);
    if (moved) {
      stalled_since_ns = 0;
      continue;
    }
    if (partner_has_ended() && bundler_->give_up_oldest()) continue;
    if (all_have_ended()) break;
    const std::int64_t pause_ns = lossless_ ? break_stall(stalled_since_ns) : kPatienceNs;
    arrived_.wait(seen, std::min(pause_ns, bundler_->deadline_ns() - now_ns));
  }
  sets_.close();
}

// A camera that will give nothing more and of which nothing is held: no set can be completed any more.
bool Intake::partner_has_ended() const noexcept {
  for (std::size_t camera = 0; camera < lanes_.size(); ++camera)
    if (lanes_[camera]->ended && bundler_->lacks(camera)) return true;
  return false;
}

bool Intake::all_have_ended() const noexcept {
  return std::all_of(lanes_.begin(), lanes_.end(), [](const auto& lane) { return lane->ended; });
}

// Carries what one camera has delivered; true when that was anything.
bool Intake::drain(std::uint32_t camera, std::int64_t now_ns) noexcept {
  Lane& lane = *lanes_[camera];
  bool moved = false;
  while (bundler_->has_room(camera)) {
    Frame frame;
    const Taken taken = lane.queue.pop(frame, 0);
    lane.ended = taken == Taken::closed;
    if (taken != Taken::value) break;
    ++lane.taken;
    lane.silent = false;
    bundler_->offer(std::move(frame), now_ns);
    moved = true;
  }
  return moved;
}

bool Intake::drain_all(std::int64_t now_ns) noexcept {
  bool moved = false;
  const auto cameras = static_cast<std::uint32_t>(lanes_.size());
  for (std::uint32_t camera = 0; camera < cameras; ++camera) moved = drain(camera, now_ns) || moved;
  // A second look at those that had nothing, later than the look at all others: a frame that came in time must be found
  // before newer ones of other cameras make the bundler give its set up.
  for (std::uint32_t camera = 0; camera < cameras; ++camera)
    if (bundler_->lacks(camera)) moved = drain(camera, now_ns) || moved;
  return moved;
}

// A set that is lost is lost for each camera.
void Intake::publish(FrameSet& set) noexcept {
  if (sets_.push(std::move(set))) return;
  LossCause cause = LossCause::over_bound;
  if (std::holds_alternative<Newest>(options_.policy)) cause = LossCause::superseded;
  if (sets_.closed()) cause = LossCause::after_close;
  for (const auto& lane : lanes_) lane->losses.count(cause);
  set.reset();
}

// Lossless: a camera that is ahead waits for room, and gets none until the camera behind delivers. When that one is
// read by the same thread, or has stopped, it never will: after stall_ns the oldest set is given up, and from then on
// at once, until the silent camera delivers again. Returns how long to sleep; 0: look again at once.
std::int64_t Intake::break_stall(std::int64_t& stalled_since_ns) noexcept {
  bool stuck = false;
  bool all_silent = true;
  for (std::size_t camera = 0; camera < lanes_.size(); ++camera) {
    const Lane& lane = *lanes_[camera];
    if (bundler_->lacks(camera)) all_silent = all_silent && lane.silent;
    // Exact: more pushes begun than taken and fitting means that its thread has one in hand and waits.
    const std::uint64_t under_way = lane.queued.load(std::memory_order_seq_cst) - lane.taken;
    if (under_way > lane.depth && !bundler_->has_room(camera)) stuck = true;
  }
  if (!stuck) {
    stalled_since_ns = 0;
    return options_.stall_ns;
  }
  const std::int64_t now_ns = host_now_ns();
  if (stalled_since_ns == 0) stalled_since_ns = now_ns;
  const std::int64_t left_ns = stalled_since_ns + options_.stall_ns - now_ns;
  if (!all_silent && left_ns > 0) return left_ns;
  for (std::size_t camera = 0; camera < lanes_.size(); ++camera)
    if (bundler_->lacks(camera)) lanes_[camera]->silent = true;
  bundler_->give_up_oldest();
  stalled_since_ns = 0;
  return 0;
}

}  // namespace rptv
