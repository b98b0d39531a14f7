// SPDX-License-Identifier: MIT
// Ends a stream from one producer to one consumer so that no value slips in behind a consumer that was told "ended".
#pragma once

#include <atomic>

namespace rptv {

/// enter/leave: producer only, around every store into the queue. ended: consumer only. close, closed: any thread.
///
/// `inside_` and `closed_` are Dekker's pair, hence seq_cst: the producer raises inside_ and then looks at closed_, the
/// consumer looks at closed_ and then at inside_. In the one total order of those four, either the consumer finds the
/// producer inside and waits for it, or the producer finds the gate closed and stores nothing.
class CloseGate {
 public:
  /// False: closed, store nothing. leave() must follow in both cases.
  bool enter() noexcept {
    inside_.store(true, std::memory_order_seq_cst);
    return !closed();
  }
  /// release: whoever sees the flag lowered also sees what was stored.
  void leave() noexcept { inside_.store(false, std::memory_order_release); }

  void close() noexcept { closed_.store(true, std::memory_order_seq_cst); }
  bool closed() const noexcept { return closed_.load(std::memory_order_seq_cst); }

  /// True: what a look into the queue after this call finds is the last there will ever be.
  bool ended() const noexcept { return closed() && !inside_.load(std::memory_order_seq_cst); }

 private:
  alignas(64) std::atomic<bool> inside_{false};  // the producer's line
  alignas(64) std::atomic<bool> closed_{false};
};

}  // namespace rptv
