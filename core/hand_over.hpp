// SPDX-License-Identifier: MIT
// One producer thread gives values to one consumer thread under a stated policy of what happens when it falls behind.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/clock.hpp"
#include "core/close_gate.hpp"
#include "core/losses.hpp"
#include "core/mailbox.hpp"
#include "core/policy.hpp"
#include "core/spsc_ring.hpp"
#include "core/wake.hpp"

namespace rptv {

/// push: producer thread only. pop: consumer thread only. close, counters: any thread. Nothing allocates after
/// construction; the only system calls are a sleep when there is nothing to do and a wake-up of a sleeper.
/// Every value given to push() is taken by pop(), or counted in `losses` once, or still waiting inside.
template <class T>
class HandOver {
 public:
  /// `losses` must outlive this object; `bound_cause` is what a full `Bounded` queue counts.
  HandOver(HandOverPolicy policy, Losses& losses, LossCause bound_cause = LossCause::over_bound)
      : policy_(policy), ring_(depth_of(policy)), losses_(losses), bound_cause_(bound_cause) {}

  /// Takes the value under every policy. False when a value was lost by it, and counted: an older one (Newest,
  /// `superseded`) or this one (Bounded and full; any policy after close(), `after_close`).
  bool push(T&& value) noexcept {
    while (true) {
      const std::uint32_t seen = drained_.prepare();  // before the attempt: room that is made after it ends the wait
      const Stored stored = store(std::move(value));
      if (stored == Stored::yes) return true;
      if (stored != Stored::no_room || !std::holds_alternative<Lossless>(policy_)) {
        losses_.count(cause_of(stored, bound_cause_));
        return false;
      }
      drained_.wait(seen, kPatienceNs);
    }
  }

  /// Waits up to `timeout_ns` (0: does not wait). `closed`: nothing waits any more and no push will succeed any more.
  Taken pop(T& value, std::int64_t timeout_ns) noexcept {
    if (take(value)) return Taken::value;
    const std::int64_t deadline_ns = timeout_ns > 0 ? host_now_ns() + timeout_ns : 0;
    while (true) {
      const std::uint32_t seen = filled_.prepare();  // before the look: what comes after it ends the wait
      const bool ended = gate_.ended();              // before the look: a push under way may still succeed
      if (take(value)) return Taken::value;
      if (ended) return Taken::closed;
      const std::int64_t left_ns = timeout_ns > 0 ? deadline_ns - host_now_ns() : 0;
      if (left_ns <= 0) return Taken::timeout;
      filled_.wait(seen, left_ns);
    }
  }

  /// Pushes fail from now on; wakes both sides. What was pushed before can still be popped.
  void close() noexcept {
    gate_.close();
    filled_.notify();
    drained_.notify();
  }
  bool closed() const noexcept { return gate_.closed(); }
  /// Values pushed and not yet popped, at some moment during the call.
  std::size_t waiting() const noexcept { return ring_.size() + (mailbox_.fresh() ? 1 : 0); }

 private:
  static constexpr std::int64_t kPatienceNs = 100'000'000;

  Stored store(T&& value) noexcept {
    const Stored stored = gate_.enter() ? store_by_policy(std::move(value)) : Stored::closed;
    gate_.leave();
    filled_.notify();  // after leave(): a consumer that waits for us to leave must wake
    return stored;
  }
  Stored store_by_policy(T&& value) noexcept {
    if (!std::holds_alternative<Newest>(policy_))
      return ring_.try_push(std::move(value)) ? Stored::yes : Stored::no_room;
    T replaced{};
    return mailbox_.put(std::move(value), replaced) ? Stored::replaced_older : Stored::yes;
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
  CloseGate gate_;
  Wake filled_, drained_;
};

}  // namespace rptv
