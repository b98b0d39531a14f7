// SPDX-License-Identifier: MIT
// Wake: no wake-up is ever lost, and waiting ends by itself.
#include "core/wake.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "core/clock.hpp"
#include "tests/core/workload.hpp"

namespace rptv {
namespace {

TEST(Wake, does_not_sleep_when_notified_after_prepare) {
  Wake wake;
  const std::uint32_t seen = wake.prepare();
  wake.notify();
  wake.wait(seen, 3'600'000'000'000);  // an hour: the test would run into its time limit
}

TEST(Wake, returns_at_once_when_no_time_is_given) {
  Wake wake;
  wake.wait(wake.prepare(), 0);
  wake.wait(wake.prepare(), -1);
}

TEST(Wake, sleeps_no_shorter_than_it_is_told_to_unless_notified) {
  Wake wake;
  const std::int64_t until_ns = host_now_ns() + 2'000'000;
  while (host_now_ns() < until_ns) wake.wait(wake.prepare(), until_ns - host_now_ns());
  EXPECT_GE(host_now_ns(), until_ns);
}

// Two threads take turns and each sleeps until it is its turn: a single lost wake-up would hang them.
TEST(Wake, loses_no_wake_up_between_two_threads_that_take_turns) {
  const std::uint64_t turns = rounds(100'000);
  Wake wake;
  std::atomic<std::uint64_t> turn{0};
  const auto take_turns = [&](std::uint64_t parity) {
    for (std::uint64_t mine = parity; mine < turns; mine += 2) {
      while (true) {
        const std::uint32_t seen = wake.prepare();
        if (turn.load(std::memory_order_acquire) == mine) break;
        wake.wait(seen, 3'600'000'000'000);
      }
      turn.store(mine + 1, std::memory_order_release);
      wake.notify();
    }
  };
  std::thread other([&] { take_turns(1); });
  take_turns(0);
  other.join();
  EXPECT_EQ(turn, turns);
}

}  // namespace
}  // namespace rptv
