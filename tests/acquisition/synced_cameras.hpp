// SPDX-License-Identifier: MIT
// Cameras on one trigger, with what goes wrong with them, in time that the test owns; each image hides its trigger.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/frame.hpp"
#include "tests/acquisition/made_frame.hpp"

namespace rptv {

/// One camera. Chances in percent per trigger. Its frame ids have 16 bits and wrap.
struct SyncedCamera {
  static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t first = 0;           ///< the first trigger that it sees
  std::uint64_t leaves_at = kNever;  ///< it sees none from here on, until
  std::uint64_t returns_at = kNever;
  int drop = 0;                    ///< the frame is lost on its way: its id is missing
  int miss = 0;                    ///< the trigger goes unseen: no id is missing
  int repeat = 0;                  ///< the frame comes twice
  double drift_ppm = 0;            ///< of its clock against the host's
  bool clock_starts_anew = false;  ///< when it returns, as after a loss of power
  std::uint64_t missed_guess = 0;  ///< how many frames its driver thinks it missed while it was away
  std::uint64_t first_id = 65'400;
};

struct TriggerTrain {
  std::uint64_t triggers = 300;
  std::int64_t period_ns = 10'000'000;
  std::int64_t pause_ns = 0;   ///< further time after every 50th trigger
  std::int64_t jitter_ns = 0;  ///< most further delay of an arrival
  bool ptp = false;            ///< the cameras' clocks are kept by PTP, to a microsecond
};

/// A frame as its source delivers it, with the number of its trigger, which nobody else knows.
struct Shown {
  std::uint64_t trigger = 0;
  FrameInfo info;
};

/// All frames of all cameras in order of arrival. Deterministic.
std::vector<Shown> show(const std::vector<SyncedCamera>& cameras, const TriggerTrain& train, std::uint64_t seed);

/// A frame in the slot, the trigger's number in its first pixels.
inline Frame shown_frame(FrameLease lease, const Shown& shown) {
  Frame frame{shown.info, kSmallShape, std::move(lease)};
  std::memcpy(frame.lease.get(), &shown.trigger, sizeof shown.trigger);
  return frame;
}

inline std::uint64_t trigger_of(const Frame& frame) {
  std::uint64_t trigger = 0;
  std::memcpy(&trigger, frame.lease.get(), sizeof trigger);
  return trigger;
}

/// The set holds one frame of each camera, all of one trigger, under one index.
inline bool is_of_one_trigger(const FrameSet& set, std::size_t cameras) {
  if (set.cameras != cameras) return false;
  for (std::uint32_t i = 0; i < set.cameras; ++i) {
    const Frame& frame = set.frames[i];
    if (frame.info.camera != i || frame.info.index != set.info().index ||
        trigger_of(frame) != trigger_of(set.frames[0]))
      return false;
  }
  return true;
}

}  // namespace rptv
