// SPDX-License-Identifier: MIT
// How far one camera's times lie from the first camera's within the sets, for others to read while sets flow.
#pragma once

#include <atomic>
#include <cstdint>
#include <cstdlib>

#include "core/clock.hpp"
#include "core/latency.hpp"

namespace rptv {

/// record(): one thread, no allocation. skew(): any thread; its percentiles may be up to 63 sets old.
class SkewMeter {
 public:
  void record(std::int64_t difference_ns) noexcept {
    histogram_.record(std::abs(difference_ns));
    sets_.store(histogram_.count(), std::memory_order_relaxed);
    max_ns_.store(histogram_.max_ns(), std::memory_order_relaxed);
    if (histogram_.count() > kEvery && histogram_.count() % kEvery != 0) return;  // a percentile costs a microsecond
    p50_ns_.store(histogram_.percentile_ns(0.5), std::memory_order_relaxed);
    p99_ns_.store(histogram_.percentile_ns(0.99), std::memory_order_relaxed);
  }
  ClockSkew skew() const noexcept {
    return {.sets = sets_.load(std::memory_order_relaxed),
            .p50_ns = p50_ns_.load(std::memory_order_relaxed),
            .p99_ns = p99_ns_.load(std::memory_order_relaxed),
            .max_ns = max_ns_.load(std::memory_order_relaxed)};
  }

 private:
  static constexpr std::uint64_t kEvery = 64;
  LatencyHistogram histogram_;
  std::atomic<std::uint64_t> sets_{0};
  std::atomic<std::int64_t> p50_ns_{0}, p99_ns_{0}, max_ns_{0};
};

}  // namespace rptv
