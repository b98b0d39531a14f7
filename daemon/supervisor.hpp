// SPDX-License-Identifier: MIT
// The main thread's side of running as a service: signals that ask to stop, and what the service manager is told.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace rptv {

/// Make one at a time, early, on the main thread: from then until its destruction SIGTERM and SIGINT (Ctrl-C) ask to
/// stop instead of killing. The first asks to drain; a SIGINT more than 100 ms later ends the process at once with code
/// 130, whatever the threads are doing (100 ms, because `timeout` and other wrappers deliver one Ctrl-C twice). All
/// methods but request_stop() and stop_requested() belong to the main thread. Outside systemd (NOTIFY_SOCKET unset) the
/// reports do nothing and everything else works the same.
///
///     Supervisor supervisor;
///     Pipeline pipeline(…);
///     supervisor.ready();
///     while (!supervisor.wait(100'000'000) && !pipeline.finished()) {
///       supervisor.status(pipeline.summary());
///       supervisor.progress(pipeline.frames_done(), pipeline.idle());
///     }
///     supervisor.stopping();
///     … drain, calling wait() and progress() as before …
class Supervisor {
 public:
  /// Throws Error(internal) when one exists already or the kernel refuses a descriptor.
  Supervisor();
  ~Supervisor();
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  /// Sleeps up to `timeout_ns`, shorter when a stop is or was asked for. True once it was; after having said so once it
  /// sleeps the whole time, so that a draining loop may go on calling it.
  bool wait(std::int64_t timeout_ns) noexcept;

  /// Any thread: the same as a first SIGTERM.
  void request_stop() noexcept;
  /// Any thread.
  bool stop_requested() const noexcept;

  /// READY=1: set-up is done and frames are taken.
  void ready() noexcept;

  /// STATUS=text: one line that `systemctl status` shows. Call it as often as you like: it is sent when it differs from
  /// the last one sent and that was at least a second ago.
  void status(const std::string& text) noexcept;

  /// The watchdog's evidence, given often (every 100 ms or so). `work_done` is any count that grows with progress,
  /// `idle` says that there is nothing to do right now (no frame waits anywhere). WATCHDOG=1 goes out at half of
  /// WATCHDOG_USEC at most, and only when the count has grown or the pipeline is idle: a stuck stage starves the
  /// watchdog even though the main thread still runs.
  void progress(std::uint64_t work_done, bool idle) noexcept;

  /// STOPPING=1: draining has begun.
  void stopping() noexcept;

  /// Nanoseconds between two WATCHDOG=1; 0 when the service manager set no watchdog.
  std::int64_t watchdog_interval_ns() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rptv
