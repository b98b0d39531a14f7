// SPDX-License-Identifier: MIT
// Absolute deadlines on the host's clock for the times of a recording, and a sleep that stop() can end.
#pragma once

#include <atomic>
#include <cstdint>

#include "core/wake.hpp"

namespace rptv {

/// start() before the threads begin; wait_until() and stop(): any thread. Nothing here allocates or throws.
class Pacer {
 public:
  /// `speed` 0: nothing is ever waited for.
  explicit Pacer(double speed) noexcept : speed_(speed) {}

  bool paced() const noexcept { return speed_ > 0; }
  /// The recording's time `first_ns` will be due at host time `at_ns`.
  void start(std::int64_t first_ns, std::int64_t at_ns) noexcept {
    first_ns_ = first_ns;
    start_ns_ = at_ns;
  }
  /// Host time at which a time of the recording is due. Requires paced().
  std::int64_t due_ns(std::int64_t recorded_ns) const noexcept {
    return start_ns_ + static_cast<std::int64_t>(static_cast<double>(recorded_ns - first_ns_) / speed_);
  }
  /// Sleeps until host time `deadline_ns`, to the scheduler's precision; false when stopped before.
  bool wait_until(std::int64_t deadline_ns) noexcept;

  void stop() noexcept {
    stopped_.store(true, std::memory_order_seq_cst);
    woken_.notify();
  }
  bool stopped() const noexcept { return stopped_.load(std::memory_order_relaxed); }

 private:
  const double speed_;
  std::int64_t first_ns_ = 0;
  std::int64_t start_ns_ = 0;
  std::atomic<bool> stopped_{false};
  Wake woken_;
};

}  // namespace rptv
