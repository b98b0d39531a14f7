// SPDX-License-Identifier: MIT
// A subscriber that only measures: how many frames arrive, how late, and what the daemon says it lost.
#pragma once

#include <cstdint>
#include <string>

#include "proto/channel.hpp"
#include "proto/text.hpp"
#include "proto/wire.hpp"

namespace rptv {

/// Connects at once; poll() receives. One thread. Latencies are right only where publisher and listener share a clock,
/// that is, on one machine.
class LiveListener {
 public:
  explicit LiveListener(const std::string& endpoint);

  /// Takes in what arrives within `timeout_ms`. False when nothing came.
  bool poll(int timeout_ms);

  std::uint64_t frames() const noexcept { return frames_; }
  std::uint64_t track_points() const noexcept { return track_points_; }
  /// Frame indices missing between the first and the last frame that came.
  std::uint64_t missing_frames() const noexcept { return frames_ > 0 ? last_frame_ - first_frame_ + 1 - frames_ : 0; }
  /// The last status message; `state` is `starting` while none has come.
  const StatusReport& status() const noexcept { return status_; }

  /// From exposure end to each stage and to this subscriber.
  const ReceivedLatency& latency() const noexcept { return latency_; }

 private:
  SubscribeChannel channel_;
  WireMessage message_;
  StatusReport status_;
  ReceivedLatency latency_;
  std::uint64_t frames_ = 0, track_points_ = 0, first_frame_ = 0, last_frame_ = 0;
};

}  // namespace rptv
