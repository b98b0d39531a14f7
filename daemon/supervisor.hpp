// SPDX-License-Identifier: MIT
// The main thread's side of running as a service: signals that ask to stop, and what the service manager is told.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

namespace rptv {

/// Make one on the main thread before any other thread starts: it blocks SIGTERM and SIGINT for itself and, because
/// threads inherit the mask, for every thread made later; they then arrive in wait() alone. The destructor restores the
/// mask. All methods but request_stop() belong to the thread that made it. Outside systemd (NOTIFY_SOCKET unset) the
/// reports do nothing and everything else works the same.
///
/// The first SIGTERM or SIGINT asks to drain: wait() returns true from then on. A second one ends the process at once
/// with code 130 (SIGINT) or 143 (SIGTERM), within wait() or after it while the pipeline drains.
///
///     Supervisor supervisor;
///     Pipeline pipeline(…);
///     supervisor.ready();
///     while (!supervisor.wait(100'000'000) && !pipeline.finished()) {
///       supervisor.status(pipeline.summary());
///       supervisor.progress(pipeline.frames_done(), pipeline.idle());
///     }
///     supervisor.stopping();
///     pipeline.drain();
class Supervisor {
 public:
  /// Throws Error(internal) when the kernel refuses a signal descriptor.
  Supervisor();
  ~Supervisor();
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  /// Sleeps up to `timeout_ns`, shorter when a signal or request_stop() comes. True once a stop was asked for; keeps
  /// returning true, then after the full timeout, so that a draining loop may go on calling it.
  bool wait(std::int64_t timeout_ns) noexcept;

  /// Any thread: the same as a first SIGTERM.
  void request_stop() noexcept;

  bool stop_requested() const noexcept { return stop_.load(std::memory_order_acquire); }

  /// READY=1: set-up is done and frames are taken.
  void ready() noexcept;

  /// STATUS=text: one line that `systemctl status` shows; sent only when it differs from the last one.
  void status(const std::string& text) noexcept;

  /// The watchdog's evidence, given often (every 100 ms or so). `work_done` is any count that grows with progress,
  /// `idle` says that there is nothing to do right now (no frame waits anywhere). WATCHDOG=1 goes out at half of
  /// WATCHDOG_USEC at most, and only when the count has grown or the pipeline is idle since the last one: a stuck stage
  /// starves the watchdog even though the main thread still runs.
  void progress(std::uint64_t work_done, bool idle) noexcept;

  /// STOPPING=1: draining has begun. From here a second signal is handled by a thread of its own, and the watchdog is
  /// fed no more: a drain that hangs is ended by TimeoutStopSec.
  void stopping() noexcept;

  /// Nanoseconds between two WATCHDOG=1; 0 when no watchdog is set.
  std::int64_t watchdog_interval_ns() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
  std::atomic<bool> stop_{false};
};

}  // namespace rptv
