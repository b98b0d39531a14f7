// SPDX-License-Identifier: MIT
// The two-part sleep: long waits can be woken, the last milliseconds are an absolute deadline.
#include "replay/pacer.hpp"

#include <ctime>

#include "core/clock.hpp"

namespace rptv {

bool Pacer::wait_until(std::int64_t deadline_ns) noexcept {
  constexpr std::int64_t kFine_ns = 10'000'000;  // also how late stop() may be heard
  while (true) {
    const std::uint32_t seen = woken_.prepare();
    if (stopped_.load(std::memory_order_seq_cst)) return false;
    const std::int64_t left_ns = deadline_ns - host_now_ns();
    if (left_ns <= 0) return true;
    if (left_ns > kFine_ns) {
      woken_.wait(seen, left_ns - kFine_ns / 2);
    } else {
      const timespec deadline{deadline_ns / 1'000'000'000, deadline_ns % 1'000'000'000};
      clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr);
    }
  }
}

}  // namespace rptv
