// SPDX-License-Identifier: MIT
// How long one frame may take to link.
#pragma once

#include <cstdint>

#include "core/clock.hpp"

namespace rptv {

/// Looks at the clock once in many steps: frames that are linked in fewer never depend on it. One thread.
class Deadline {
 public:
  static constexpr std::uint32_t kStepsPerLook = 4096;

  /// Of a frame that begins now; 0: none.
  void start(std::int64_t limit_ns) noexcept {
    end_ns_ = limit_ns > 0 ? host_now_ns() + limit_ns : INT64_MAX;
    steps_ = 0;
    passed_ = false;
  }
  /// After `steps` more of some 10 ns each.
  bool passed(std::uint32_t steps) noexcept {
    steps_ += steps;
    if (steps_ < kStepsPerLook) return passed_;
    steps_ = 0;
    if (end_ns_ != INT64_MAX && !passed_) passed_ = host_now_ns() >= end_ns_;
    return passed_;
  }

 private:
  std::int64_t end_ns_ = INT64_MAX;
  std::uint32_t steps_ = 0;
  bool passed_ = false;
};

}  // namespace rptv
