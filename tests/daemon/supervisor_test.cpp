// SPDX-License-Identifier: MIT
// The supervisor against a real notify socket and real signals.
#include "daemon/supervisor.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>

#include "core/clock.hpp"
#include "core/error.hpp"
#include "tests/daemon/notify_socket.hpp"

namespace rptv {
namespace {

constexpr std::int64_t kMillisecondNs = 1'000'000;
constexpr std::int64_t kLongNs = 60'000 * kMillisecondNs;
constexpr int kLongMs = 60'000;

/// A watchdog as the service manager would set it, for this process.
class Watchdog {
 public:
  explicit Watchdog(int interval_us) {
    setenv("WATCHDOG_USEC", std::to_string(interval_us).c_str(), 1);
    setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
  }
  ~Watchdog() {
    unsetenv("WATCHDOG_USEC");
    unsetenv("WATCHDOG_PID");
  }
};

/// Reports progress until a datagram comes (bounded by a minute) and returns it; `work` grows by `step` each time.
std::string report_until_told(Supervisor& supervisor, NotifySocket& manager, std::uint64_t& work, std::uint64_t step,
                              bool idle, std::int64_t for_ns = kLongNs) {
  const std::int64_t until_ns = host_now_ns() + for_ns;
  while (host_now_ns() < until_ns) {
    supervisor.progress(work += step, idle);
    if (const std::string told = manager.receive(1); !told.empty()) return told;
  }
  return {};
}

TEST(Supervisor, tells_the_service_manager_when_it_is_ready_and_when_it_stops) {
  NotifySocket manager;
  Supervisor supervisor;
  EXPECT_EQ(manager.receive(0), "");
  supervisor.ready();
  EXPECT_NE(manager.receive(kLongMs).find("READY=1"), std::string::npos);
  supervisor.stopping();
  EXPECT_NE(manager.receive(kLongMs).find("STOPPING=1"), std::string::npos);
}

TEST(Supervisor, sends_a_status_when_it_changed_and_a_second_passed) {
  NotifySocket manager;
  Supervisor supervisor;
  supervisor.status("12 frames");
  EXPECT_EQ(manager.receive(kLongMs), "STATUS=12 frames");
  supervisor.status("12 frames");
  EXPECT_EQ(manager.receive(0), "");
  const std::int64_t first_ns = host_now_ns();
  std::string told;
  for (int frames = 13; told.empty() && host_now_ns() - first_ns < kLongNs; ++frames) {
    supervisor.status(std::to_string(frames) + " frames");
    told = manager.receive(1);
  }
  EXPECT_NE(told, "STATUS=12 frames");
  EXPECT_EQ(told.rfind("STATUS=", 0), 0U);
  EXPECT_GE(host_now_ns() - first_ns, 900 * kMillisecondNs);
}

TEST(Supervisor, feeds_the_watchdog_at_half_its_interval_while_work_grows) {
  NotifySocket manager;
  Watchdog watchdog(200'000);
  Supervisor supervisor;
  EXPECT_EQ(supervisor.watchdog_interval_ns(), 100 * kMillisecondNs);
  supervisor.ready();
  EXPECT_NE(manager.receive(kLongMs).find("WATCHDOG=1"), std::string::npos);
  std::uint64_t work = 0;
  const std::int64_t start_ns = host_now_ns();
  for (int fed = 0; fed < 3; ++fed) EXPECT_EQ(report_until_told(supervisor, manager, work, 1, false), "WATCHDOG=1");
  EXPECT_GE(host_now_ns() - start_ns, 250 * kMillisecondNs);
}

TEST(Supervisor, starves_the_watchdog_when_a_stage_is_stuck) {
  NotifySocket manager;
  Watchdog watchdog(100'000);
  Supervisor supervisor;
  std::uint64_t work = 7;
  EXPECT_EQ(report_until_told(supervisor, manager, work, 1, false), "WATCHDOG=1");
  EXPECT_EQ(report_until_told(supervisor, manager, work, 0, false, 300 * kMillisecondNs), "");
  EXPECT_EQ(report_until_told(supervisor, manager, work, 1, false), "WATCHDOG=1");
}

TEST(Supervisor, feeds_the_watchdog_while_there_is_nothing_to_do) {
  NotifySocket manager;
  Watchdog watchdog(100'000);
  Supervisor supervisor;
  std::uint64_t work = 0;
  for (int fed = 0; fed < 2; ++fed) EXPECT_EQ(report_until_told(supervisor, manager, work, 0, true), "WATCHDOG=1");
}

TEST(Supervisor, ignores_a_watchdog_meant_for_another_process) {
  Watchdog watchdog(100'000);
  setenv("WATCHDOG_PID", "1", 1);
  EXPECT_EQ(Supervisor().watchdog_interval_ns(), 0);
}

TEST(Supervisor, works_without_a_service_manager) {
  unsetenv("NOTIFY_SOCKET");
  Supervisor supervisor;
  supervisor.ready();
  supervisor.status("x");
  supervisor.progress(1, true);
  EXPECT_FALSE(supervisor.wait(kMillisecondNs));
  supervisor.stopping();
}

TEST(Supervisor, drains_at_the_first_signal_and_takes_a_repeated_sigterm_calmly) {
  for (const int signal : {SIGTERM, SIGINT}) {
    Supervisor supervisor;
    EXPECT_FALSE(supervisor.stop_requested());
    raise(signal);
    const std::int64_t asked_ns = host_now_ns();
    EXPECT_TRUE(supervisor.wait(kLongNs));
    EXPECT_LT(host_now_ns() - asked_ns, kLongNs);
    EXPECT_TRUE(supervisor.wait(150 * kMillisecondNs));
    EXPECT_GE(host_now_ns() - asked_ns, 150 * kMillisecondNs);  // told once, it sleeps the whole time
    raise(SIGTERM);
    EXPECT_TRUE(supervisor.stop_requested());
  }
}

TEST(Supervisor, is_woken_by_a_stop_from_another_thread) {
  Supervisor supervisor;
  std::thread control([&] { supervisor.request_stop(); });
  const std::int64_t start_ns = host_now_ns();
  EXPECT_TRUE(supervisor.wait(kLongNs));
  EXPECT_LT(host_now_ns() - start_ns, kLongNs);
  control.join();
}

TEST(Supervisor, gives_the_signals_back) {
  { Supervisor supervisor; }
  for (const int signal : {SIGTERM, SIGINT}) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    EXPECT_EQ(action.sa_handler, SIG_DFL);
  }
}

TEST(Supervisor, refuses_to_exist_twice) {
  Supervisor supervisor;
  EXPECT_THROW(Supervisor{}, Error);
  raise(SIGTERM);  // still in the first one's hands
  EXPECT_TRUE(supervisor.stop_requested());
}

TEST(SupervisorDeathTest, stops_at_once_at_the_second_ctrl_c) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        Supervisor supervisor;
        raise(SIGINT);
        supervisor.wait(kLongNs);
        supervisor.wait(150 * kMillisecondNs);
        raise(SIGINT);
        std::_Exit(0);
      },
      testing::ExitedWithCode(130), "");
}

}  // namespace
}  // namespace rptv
