// SPDX-License-Identifier: MIT
// The futex calls behind core/wake.hpp.
#include "core/wake.hpp"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <climits>
#include <ctime>

namespace rptv {

// seq_cst throughout: wait() publishes itself in sleepers_ and then lets the kernel compare epoch_; notify() bumps
// epoch_ and then reads sleepers_. In any total order of those four either notify sees the sleeper or the kernel sees
// the new epoch, so no wake-up is lost.
static_assert(sizeof(std::atomic<std::uint32_t>) == 4 && std::atomic<std::uint32_t>::is_always_lock_free);

void Wake::wait(std::uint32_t seen, std::int64_t timeout_ns) noexcept {
  if (timeout_ns <= 0) return;
  sleepers_.fetch_add(1, std::memory_order_seq_cst);
  const timespec timeout{timeout_ns / 1'000'000'000, timeout_ns % 1'000'000'000};
  syscall(SYS_futex, &epoch_, FUTEX_WAIT_PRIVATE, seen, &timeout, nullptr, 0);
  sleepers_.fetch_sub(1, std::memory_order_seq_cst);
}

void Wake::notify() noexcept {
  epoch_.fetch_add(1, std::memory_order_seq_cst);
  if (sleepers_.load(std::memory_order_seq_cst) != 0)
    syscall(SYS_futex, &epoch_, FUTEX_WAKE_PRIVATE, INT_MAX, nullptr, nullptr, 0);
}

}  // namespace rptv
