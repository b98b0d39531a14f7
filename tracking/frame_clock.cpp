// SPDX-License-Identifier: MIT
// Believes or mends each step of the camera's clock; every overflow of 64 bits is a fault as well.
#include "tracking/frame_clock.hpp"

#include <algorithm>

namespace rptv {

namespace {
constexpr std::uint64_t kMostFrames = 1'000'000'000;  // longer gaps end every memory all the same
constexpr std::int64_t kMostNs = INT64_MAX / 2;
}  // namespace

const FrameTime& FrameClock::advance(std::uint64_t frame, std::int64_t exposure_end_ns) noexcept {
  if (started_) {
    const bool increases = frame > last_frame_;
    if (!increases) ++frame_faults_;
    const std::uint64_t frames = increases ? std::min(frame - last_frame_, kMostFrames) : 1;
    now_.frame += frames;
    now_.frames_since_last = frames;
    if (!believe(exposure_end_ns, static_cast<std::int64_t>(frames))) {
      ++clock_faults_;
      ++now_.epoch;
      std::int64_t stand_in_ns = 0;
      if (__builtin_mul_overflow(step_ns_, static_cast<std::int64_t>(frames), &stand_in_ns)) stand_in_ns = step_ns_;
      now_.ns = std::min(now_.ns, kMostNs) + std::min(stand_in_ns, kMostNs);
    }
  }
  started_ = true;
  last_frame_ = frame;
  last_exposure_ns_ = exposure_end_ns;
  return now_;
}

bool FrameClock::believe(std::int64_t exposure_end_ns, std::int64_t frames) noexcept {
  std::int64_t step_ns = 0;
  std::int64_t now_ns = 0;
  if (__builtin_sub_overflow(exposure_end_ns, last_exposure_ns_, &step_ns) || step_ns <= 0) return false;
  if (__builtin_add_overflow(now_.ns, step_ns, &now_ns)) return false;
  const std::int64_t per_frame_ns = std::max<std::int64_t>(step_ns / frames, 1);
  if (longest_step_ns_ != 0 && per_frame_ns / kJumpFactor > longest_step_ns_) return false;
  longest_step_ns_ = std::max(longest_step_ns_, per_frame_ns);
  step_ns_ = per_frame_ns;
  now_.ns = now_ns;
  return true;
}

}  // namespace rptv
