// SPDX-License-Identifier: MIT
// What the daemon says about itself once per status period: state, rates, losses, latencies, queues, warnings.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/latency.hpp"
#include "core/losses.hpp"
#include "proto/camera_report.hpp"
#include "proto/drift_report.hpp"

namespace rptv {

enum class RunState : std::uint8_t { starting, running, draining, stopped, failed, count_ };
inline constexpr std::size_t kRunStateCount = static_cast<std::size_t>(RunState::count_);

constexpr std::string_view name_of(RunState state) noexcept {
  constexpr std::array<std::string_view, kRunStateCount> kNames{"starting", "running", "draining", "stopped", "failed"};
  return kNames[static_cast<std::size_t>(state)];
}

/// Durations from exposure end to one stage, in ns. `count` 0: that stage was not reached.
struct LatencySummary {
  std::uint64_t count = 0;
  std::int64_t p50_ns = 0, p99_ns = 0, p999_ns = 0, max_ns = 0;
};
LatencySummary summary_of(const LatencyHistogram& histogram) noexcept;

/// Losses of one cause at one place since start.
struct LossCount {
  std::string place;  ///< a camera's name, or the part of the daemon that lost it
  LossCause cause = LossCause::source_gap;
  std::uint64_t count = 0;
};

/// Appends one entry for each cause that has been counted at `place`.
void append_losses(std::vector<LossCount>& out, std::string_view place, const Losses& losses);

/// One hand-over between threads.
struct QueueFill {
  std::string name;
  std::uint64_t waiting = 0;
  std::uint64_t capacity = 0;
};

/// Counters run since the daemon's start; rates and latencies cover the time since the last status.
struct StatusReport {
  RunState state = RunState::starting;
  std::uint64_t frames_in = 0;      ///< frame sets that reached reconstruction
  std::uint64_t results_out = 0;    ///< frames whose tracks were offered to the publisher
  std::uint64_t messages_sent = 0;  ///< by the publisher, all topics
  std::uint64_t queue_full = 0;     ///< times at which a subscriber's queue was found full (it then loses messages)
  double input_hz = 0, output_hz = 0;
  std::array<LatencySummary, kStageCount> latency{};  ///< by Stage
  std::vector<LossCount> losses;
  std::vector<QueueFill> queues;
  std::vector<std::string> warnings;  ///< one line each, with the next step
  std::vector<CameraReport> cameras;  ///< those that are devices, in camera order
  DriftReport drift;

  /// Back to the defaults, keeping the vectors' memory.
  void clear() noexcept;
};

}  // namespace rptv
