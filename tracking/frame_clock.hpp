// SPDX-License-Identifier: MIT
// Turns frame indices and exposure times, with their faults, into a time that only goes forward.
#pragma once

#include <cstdint>

namespace rptv {

/// The linker's own time, which starts at 0 with the first frame.
struct FrameTime {
  std::int64_t ns = 0;
  std::uint64_t frame = 0;
  std::uint64_t frames_since_last = 0;
  std::uint32_t epoch = 0;  ///< goes up with every clock fault: dt is measured only within one epoch
};

/// One thread. A step of the clock is believed when it is positive and, per frame, at most kJumpFactor times the
/// longest one believed before; else it is a fault, and the previous step per frame stands in for it.
class FrameClock {
 public:
  static constexpr std::int64_t kJumpFactor = 1000;

  const FrameTime& advance(std::uint64_t frame, std::int64_t exposure_end_ns) noexcept;

  std::int64_t period_ns() const noexcept { return step_ns_; }  ///< the last step believed, per frame; 0 before it
  std::uint64_t clock_faults() const noexcept { return clock_faults_; }
  std::uint64_t frame_faults() const noexcept {
    return frame_faults_;
  }  ///< index did not increase: counts as one frame

 private:
  bool believe(std::int64_t exposure_end_ns, std::int64_t frames) noexcept;

  FrameTime now_;
  bool started_ = false;
  std::uint64_t last_frame_ = 0;
  std::int64_t last_exposure_ns_ = 0;
  std::int64_t step_ns_ = 0;          // per frame, the last one believed
  std::int64_t longest_step_ns_ = 0;  // per frame
  std::uint64_t clock_faults_ = 0;
  std::uint64_t frame_faults_ = 0;
};

}  // namespace rptv
