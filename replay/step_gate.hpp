// SPDX-License-Identifier: MIT
// Keeps the threads of several cameras within a few instants of each other.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "core/frame.hpp"
#include "core/wake.hpp"

namespace rptv {

/// Real cameras share a trigger and cannot run away from each other; threads that play as fast as possible can. A
/// camera enters a step when no other camera is more than kLead steps behind. Each camera's methods: its own thread;
/// stop(): any thread. Nothing here allocates, and nothing is locked: counters, and a futex to sleep on.
class StepGate {
 public:
  static constexpr std::uint64_t kLead = 2;

  explicit StepGate(std::uint32_t cameras) noexcept : cameras_(cameras) {}

  /// Waits for its turn; false when stopped.
  bool enter(std::uint64_t step) noexcept { return step < kLead || wait_for_all(step - kLead, cameras_); }
  /// Waits until every camera but `self` has done `step`; false when stopped.
  bool wait_for_others(std::uint32_t self, std::uint64_t step) noexcept { return wait_for_all(step + 1, self); }

  /// `camera` has done one more step.
  void done(std::uint32_t camera) noexcept {
    // release: with the acquire in wait_for_all(), what was delivered before is delivered before what waits for it.
    done_[camera].store(done_[camera].load(std::memory_order_relaxed) + 1, std::memory_order_release);
    if (cameras_ > 1) moved_.notify();
  }
  /// `camera` does no more steps and holds nobody up.
  void leave(std::uint32_t camera) noexcept {
    done_[camera].store(UINT64_MAX, std::memory_order_release);
    moved_.notify();
  }
  void stop() noexcept {
    stopped_.store(true, std::memory_order_seq_cst);
    moved_.notify();
  }

 private:
  static constexpr std::int64_t kPatience_ns = 100'000'000;

  bool all_have(std::uint64_t steps, std::uint32_t except) const noexcept {
    for (std::uint32_t camera = 0; camera < cameras_; ++camera)
      if (camera != except && done_[camera].load(std::memory_order_acquire) < steps) return false;
    return true;
  }
  bool wait_for_all(std::uint64_t steps, std::uint32_t except) noexcept {
    while (true) {
      const std::uint32_t seen = moved_.prepare();
      if (stopped_.load(std::memory_order_seq_cst)) return false;
      if (all_have(steps, except)) return true;
      moved_.wait(seen, kPatience_ns);
    }
  }

  const std::uint32_t cameras_;
  std::array<std::atomic<std::uint64_t>, kMaxCameras> done_{};
  std::atomic<bool> stopped_{false};
  Wake moved_;
};

}  // namespace rptv
