// SPDX-License-Identifier: MIT
// Published messages as text for people and JSON lines for scripts, and the latency that a subscriber sees.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "core/latency.hpp"
#include "proto/wire.hpp"

namespace rptv {

/// One line without its end. `received_ns`: CLOCK_MONOTONIC at arrival, or 0 when the publisher's clock is another
/// machine's (then no latency to the subscriber is shown).
std::string to_line(const WireMessage& message, std::int64_t received_ns);

/// One JSON object without line end, with everything that is in the message; columns as arrays, units mm, mm/s and ns.
/// NaN and infinities become null.
std::string to_json(const WireMessage& message, std::int64_t received_ns);

/// Durations from exposure end to each stage and to this subscriber. One thread at a time.
class ReceivedLatency {
 public:
  /// Messages without stamps (status, rig) are ignored; `received_ns` as in to_line.
  void record(const WireMessage& message, std::int64_t received_ns) noexcept;
  /// A table in ms with one line per stage that was reached; the last is `received`. Ends with a line end.
  std::string table() const;
  /// The same as one JSON object in ns.
  std::string json() const;

 private:
  std::array<LatencyHistogram, kStageCount> stages_;
  LatencyHistogram received_;
};

/// How many messages were lost by this subscriber, from the jumps of Envelope.sequence.
class SequenceCheck {
 public:
  /// Returns how many messages of this topic are missing just before this one. A new session starts afresh.
  std::uint64_t missing_before(Topic topic, const WireMessage& message);
  std::uint64_t missing() const noexcept { return missing_; }

 private:
  std::string session_;
  std::array<std::uint64_t, kTopicCount> expected_{};
  std::array<bool, kTopicCount> started_{};
  std::uint64_t missing_ = 0;
};

}  // namespace rptv
