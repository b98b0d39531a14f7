// SPDX-License-Identifier: MIT
// Lets a thread sleep until another one has made progress: an event count on a futex, free when nobody sleeps.
#pragma once

#include <atomic>
#include <cstdint>

namespace rptv {

/// Use: `seen = wake.prepare(); if (condition) …; else wake.wait(seen, timeout)`, and on the other side
/// "change the condition, then notify()". A change between prepare and wait makes wait return at once.
/// prepare/wait: any number of threads. notify: any thread; one system call only when somebody sleeps.
class Wake {
 public:
  std::uint32_t prepare() const noexcept { return epoch_.load(std::memory_order_seq_cst); }
  /// Sleeps until notified after `seen` was read, or `timeout_ns` passed, or spuriously.
  void wait(std::uint32_t seen, std::int64_t timeout_ns) noexcept;
  void notify() noexcept;

 private:
  std::atomic<std::uint32_t> epoch_{0};
  std::atomic<std::uint32_t> sleepers_{0};
};

}  // namespace rptv
