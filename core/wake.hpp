// SPDX-License-Identifier: MIT
// Lets a thread sleep until another one has made progress: an event count on a futex, without a system call when nobody
// sleeps.
#pragma once

#include <atomic>
#include <cstdint>

namespace rptv {

/// Use: `seen = wake.prepare(); if (condition) …; else wake.wait(seen, timeout)`, and on the other side
/// "change the condition, then notify()". A change between prepare and wait makes wait return at once.
/// prepare/wait: any number of threads. notify: any thread; one read-modify-write, a system call only for a sleeper.
/// The epoch wraps after 2³² notifications: a waiter would have to sit between prepare and wait for all of them.
class alignas(64) Wake {
 public:
  std::uint32_t prepare() const noexcept { return epoch_.load(std::memory_order_seq_cst); }
  /// Sleeps until notified after `seen` was read, or `timeout_ns` passed, or spuriously; not at all when it is <= 0.
  void wait(std::uint32_t seen, std::int64_t timeout_ns) noexcept;
  void notify() noexcept;

 private:
  std::atomic<std::uint32_t> epoch_{0};
  std::atomic<std::uint32_t> sleepers_{0};
};

}  // namespace rptv
