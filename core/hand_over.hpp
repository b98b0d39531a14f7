// SPDX-License-Identifier: MIT
// One producer thread gives values to one consumer thread under a stated policy of what happens when it falls behind.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <variant>

#include "core/clock.hpp"
#include "core/losses.hpp"
#include "core/mailbox.hpp"
#include "core/spsc_ring.hpp"
#include "core/wake.hpp"

namespace rptv {

/// Live view: the consumer gets the newest value; what it had no time for is lost as `superseded`.
struct Newest {};
/// Recordings: the producer waits for room (up to `depth` in flight); nothing is lost.
struct Lossless {
  std::size_t depth = 8;
};
/// Bounded delay: at most `depth` wait; what comes to a full queue is lost as `over_bound`.
struct Bounded {
  std::size_t depth = 8;
};
using HandOverPolicy = std::variant<Newest, Lossless, Bounded>;

enum class Taken : std::uint8_t { value, timeout, closed };

/// push: producer thread only. pop: consumer thread only. close, counters: any thread. Nothing allocates after
/// construction; the only system calls are a sleep when there is nothing to do and a wake-up of a sleeper.
template <class T>
class HandOver {
 public:
  /// `losses` must outlive this object; `bound_cause` is what a full `Bounded` queue counts.
  HandOver(HandOverPolicy policy, Losses& losses, LossCause bound_cause = LossCause::over_bound)
      : policy_(policy), ring_(depth_of(policy)), losses_(losses), bound_cause_(bound_cause) {}

  /// Takes the value under every policy; returns false when it (Bounded, closed) or an older one (Newest) was lost.
  bool push(T&& value) noexcept {
    if (std::holds_alternative<Newest>(policy_)) {
      T replaced{};
      const bool lost = mailbox_.put(std::move(value), replaced);
      if (lost) losses_.count(LossCause::superseded);
      filled_.notify();
      return !lost;
    }
    const std::size_t depth = depth_of(policy_);
    while (!closed()) {
      const std::uint32_t seen = drained_.prepare();
      if (ring_.size() < depth && ring_.try_push(std::move(value))) {
        filled_.notify();
        return true;
      }
      if (std::holds_alternative<Bounded>(policy_)) break;
      drained_.wait(seen, kPatienceNs);
    }
    losses_.count(bound_cause_);
    return false;
  }

  /// Waits up to `timeout_ns` (0: does not wait). `closed` only after everything pushed before close() was taken.
  Taken pop(T& value, std::int64_t timeout_ns) noexcept {
    const std::int64_t deadline_ns = timeout_ns > 0 ? host_now_ns() + timeout_ns : 0;
    while (true) {
      const std::uint32_t seen = filled_.prepare();
      const bool was_closed = closed();  // read before the queue: what was pushed before close() must still be found
      if (take(value)) return Taken::value;
      if (was_closed) return Taken::closed;
      const std::int64_t left_ns = timeout_ns > 0 ? deadline_ns - host_now_ns() : 0;
      if (left_ns <= 0) return Taken::timeout;
      filled_.wait(seen, left_ns);
    }
  }

  /// No more pushes will count; wakes both sides.
  void close() noexcept {
    closed_.store(true, std::memory_order_seq_cst);
    filled_.notify();
    drained_.notify();
  }
  bool closed() const noexcept { return closed_.load(std::memory_order_seq_cst); }
  std::size_t waiting() const noexcept { return ring_.size(); }

 private:
  static constexpr std::int64_t kPatienceNs = 100'000'000;
  static std::size_t depth_of(const HandOverPolicy& policy) noexcept {
    if (const auto* lossless = std::get_if<Lossless>(&policy)) return lossless->depth;
    if (const auto* bounded = std::get_if<Bounded>(&policy)) return bounded->depth;
    return 1;
  }
  bool take(T& value) noexcept {
    if (std::holds_alternative<Newest>(policy_)) return mailbox_.take(value);
    if (!ring_.try_pop(value)) return false;
    if (std::holds_alternative<Lossless>(policy_)) drained_.notify();
    return true;
  }

  const HandOverPolicy policy_;
  SpscRing<T> ring_;
  Mailbox<T> mailbox_;
  Losses& losses_;
  const LossCause bound_cause_;
  std::atomic<bool> closed_{false};
  Wake filled_;
  Wake drained_;
};

}  // namespace rptv
