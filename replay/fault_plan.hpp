// SPDX-License-Identifier: MIT
// Which frames of a replay get which fault: a pure function of seed, step and camera, never of timing.
#pragma once

#include <cstdint>

#include "replay/replay_settings.hpp"

namespace rptv {

/// At most one of these per frame.
enum class FrameFault : std::uint8_t { none, drop, duplicate, torn };

/// What was really done to one camera's frames since the start.
struct InjectedFaults {
  std::uint64_t dropped = 0;      ///< never delivered: the sink sees a gap in the index
  std::uint64_t duplicated = 0;   ///< delivered a second time
  std::uint64_t torn = 0;         ///< delivered with `torn` set and the lower rows zero
  std::uint64_t reordered = 0;    ///< delivered after every other camera's next frame
  std::uint64_t bunched = 0;      ///< held back to arrive with the next
  std::uint64_t clock_jumps = 0;  ///< shifts of the camera's clock
};

/// A step is an instant counted since the start of the replay: it goes on over loops, so loops differ in their faults.
class FaultPlan {
 public:
  static constexpr std::uint64_t kLongestBunch = 4;

  /// Throws Error(configuration) when the fractions of drop, duplicate and torn exceed 1 together.
  explicit FaultPlan(const ReplayFaults& faults);

  FrameFault frame_fault(std::uint64_t step, std::uint32_t camera) const noexcept;
  /// Rows that a torn frame still has, as a fraction.
  double kept_fraction(std::uint64_t step, std::uint32_t camera) const noexcept;
  /// True: this frame waits for the next one of its camera. Bunches do not cross multiples of kLongestBunch.
  bool waits_for_next(std::uint64_t step, std::uint32_t camera) const noexcept;
  bool clock_jumps(std::uint64_t step, std::uint32_t camera) const noexcept;
  /// True: of `cameras`, this one delivers after the others' next step. Never in two steps running, so that no two
  /// cameras wait for each other.
  bool is_late(std::uint64_t step, std::uint32_t camera, std::uint32_t cameras) const noexcept;

 private:
  /// Uniform in [0, 1): splitmix64 (Steele, Lea, Flood 2014) over seed, step, camera and purpose.
  double draw(std::uint64_t step, std::uint32_t camera, std::uint32_t purpose) const noexcept;
  ReplayFaults faults_;
};

}  // namespace rptv
