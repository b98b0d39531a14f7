// SPDX-License-Identifier: MIT
// The loop of one camera's thread.
#include "replay/camera_player.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>

#include "core/clock.hpp"

namespace rptv {

void FailureText::set(const char* text) noexcept {
  if (taken_.exchange(true, std::memory_order_relaxed)) return;
  std::snprintf(text_.data(), text_.size(), "%s", text);
  written_.store(true, std::memory_order_release);
}

void CameraPlayer::run(FrameSink& sink) noexcept {
  for (std::uint64_t step = 0; step < play_.steps && play_.gate.enter(step) && !play_.pacer.stopped(); ++step) {
    play_step(sink, step);
    play_.gate.done(camera_);
  }
  play_.gate.leave(camera_);
}

void CameraPlayer::play_step(FrameSink& sink, std::uint64_t step) noexcept {
  if (play_.plan.clock_jumps(step, camera_)) {
    shifted_ns_ += play_.clock_jump_ns;
    add(clock_jumps_);
  }
  const Shot& shot = shot_of(step);
  if (shot.image == Shot::kNone) return;
  const FrameFault fault = play_.plan.frame_fault(step, camera_);
  // A sink sees a loss only between two frames that it got, so the first and the last always come.
  if (fault == FrameFault::drop && step != 0 && step + 1 != play_.steps) {
    add(dropped_);
    return;
  }
  const bool torn = fault == FrameFault::torn;
  if (!deliver(sink, shot, step, torn)) return;
  if (torn) add(torn_);
  if (fault == FrameFault::duplicate && deliver(sink, shot, step, false)) add(duplicated_);
}

/// The slot is filled before the frame is due, so that neither copy nor decoding delays it. A copy is made in the half
/// period before, as an image comes from a camera: right after the frame before it, it would take the processors from
/// what is done with that.
bool CameraPlayer::deliver(FrameSink& sink, const Shot& shot, std::uint64_t step, bool torn) noexcept {
  if (decoded_ != nullptr && play_.pacer.paced() &&
      !play_.pacer.wait_until(play_.pacer.due_ns(recorded_ns(step) - play_.timeline.period_ns / 2)))
    return false;
  Frame frame;
  frame.shape = images_.shape();
  frame.lease = sink.claim(camera_);
  FrameInfo& info = frame.info;
  info.exposure_end_host_ns = host_now_ns();
  if (frame.lease) {
    info.torn = !fill(shot.image, frame.lease.get()) || torn;
    if (torn) tear(step, frame.lease.get());
  }
  if (!wait_for_turn(step) || !frame.lease) return false;
  const Timeline& timeline = play_.timeline;
  const std::uint64_t loop = step / timeline.instants();
  info.index = timeline.index[step % timeline.instants()] + loop * timeline.loop_indices;
  info.camera = camera_;
  info.clock = timeline.clock;
  info.exposure_end_ns = recorded_ns(step) + shifted_ns_;
  if (play_.pacer.paced()) info.exposure_end_host_ns = play_.pacer.due_ns(recorded_ns(step));
  info.arrival_ns = host_now_ns();
  sink.deliver(std::move(frame));
  return true;
}

bool CameraPlayer::fill(std::size_t image, std::byte* pixels) noexcept {
  const std::size_t bytes = images_.shape().bytes();
  if (decoded_ != nullptr) {
    std::memcpy(pixels, decoded_->image(image), bytes);
    return true;
  }
  try {
    reader_.decode(image, {pixels, bytes});
    return true;
  } catch (const std::exception& error) {
    play_.failure.set(error.what());
    add(undecodable_);
    return false;
  }
}

void CameraPlayer::tear(std::uint64_t step, std::byte* pixels) const noexcept {
  const ImageShape& shape = images_.shape();
  const auto rows = static_cast<std::size_t>(play_.plan.kept_fraction(step, camera_) * shape.height_px);
  std::memset(pixels + rows * shape.row_bytes(), 0, (shape.height_px - rows) * shape.row_bytes());
}

/// Sleeps until the frame may leave: its own time, or that of the last frame of its bunch, and after the other cameras
/// if it is the late one. False when the play was stopped.
bool CameraPlayer::wait_for_turn(std::uint64_t step) noexcept {
  std::uint64_t together = step;
  while (together + 1 < play_.steps && shot_of(together + 1).image != Shot::kNone &&
         play_.plan.waits_for_next(together, camera_))
    ++together;
  if (together != step) add(bunched_);
  if (play_.pacer.paced()) {
    const std::int64_t due_ns = play_.pacer.due_ns(recorded_ns(together));
    if (!play_.pacer.wait_until(due_ns)) return false;
    worst_lateness_ns_.store(std::max(worst_lateness_ns_.load(std::memory_order_relaxed), host_now_ns() - due_ns),
                             std::memory_order_relaxed);
  }
  if (step + 1 < play_.steps &&
      play_.plan.is_late(step, camera_, static_cast<std::uint32_t>(play_.timeline.shots.size()))) {
    if (!play_.gate.wait_for_others(camera_, step + 1)) return false;
    add(reordered_);
  }
  return !play_.pacer.stopped();
}

std::int64_t CameraPlayer::recorded_ns(std::uint64_t step) const noexcept {
  const std::uint64_t loop = step / play_.timeline.instants();
  return shot_of(step).time_ns + static_cast<std::int64_t>(loop) * play_.timeline.loop_ns;
}

InjectedFaults CameraPlayer::injected() const noexcept {
  const auto read = [](const Counter& counter) { return counter.load(std::memory_order_relaxed); };
  return {read(dropped_), read(duplicated_), read(torn_), read(reordered_), read(bunched_), read(clock_jumps_)};
}

}  // namespace rptv
