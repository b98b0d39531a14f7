// SPDX-License-Identifier: MIT
// Status reports: emptying one, and a histogram's summary.
#include "proto/status.hpp"

namespace rptv {

LatencySummary summary_of(const LatencyHistogram& histogram) noexcept {
  return {.count = histogram.count(),
          .p50_ns = histogram.percentile_ns(0.5),
          .p99_ns = histogram.percentile_ns(0.99),
          .p999_ns = histogram.percentile_ns(0.999),
          .max_ns = histogram.max_ns()};
}

void append_losses(std::vector<LossCount>& out, std::string_view place, const Losses& losses) {
  const auto counts = losses.snapshot();
  for (std::size_t i = 0; i < kLossCauseCount; ++i)
    if (counts[i] != 0) out.push_back({std::string(place), static_cast<LossCause>(i), counts[i]});
}

void StatusReport::clear() noexcept {
  state = RunState::starting;
  frames_in = results_out = messages_sent = queue_full = 0;
  input_hz = output_hz = 0;
  latency = {};
  losses.clear();
  queues.clear();
  warnings.clear();
  cameras.clear();
  drift = {};
}

}  // namespace rptv
