// SPDX-License-Identifier: MIT
// Fires a camera's software trigger; for the aravis_*.cpp files only.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>

#include "acquisition/aravis_handle.hpp"

namespace rptv {

/// At the multiples of a period of the host's clock, so that all cameras of this process are fired together, as well as
/// their threads wake up together and the commands, one for each camera, travel together. One thread fires; counters:
/// any thread.
class SoftwareTrigger {
 public:
  /// 0: never.
  explicit SoftwareTrigger(std::int64_t period_ns) noexcept : period_ns_(period_ns) {}

  /// When it is to be fired next, CLOCK_MONOTONIC; far away where never.
  std::int64_t due_ns() const noexcept { return due_ns_; }
  /// The camera is ready from now on: its next multiple is the first.
  void begin(std::int64_t now_ns) noexcept;
  /// Fires when it is due. False when the camera did not take the command.
  bool fire(ArvCamera* camera, std::int64_t now_ns) noexcept;

  std::uint64_t fired() const noexcept { return fired_.load(std::memory_order_relaxed); }
  /// Multiples that were over before the command before them was answered: no image was asked for.
  std::uint64_t skipped() const noexcept { return skipped_.load(std::memory_order_relaxed); }

 private:
  const std::int64_t period_ns_;
  std::int64_t due_ns_ = std::numeric_limits<std::int64_t>::max();
  std::atomic<std::uint64_t> fired_{0}, skipped_{0};
};

}  // namespace rptv
