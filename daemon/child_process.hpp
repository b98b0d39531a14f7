// SPDX-License-Identifier: MIT
// A second rapidptv as a child process: how the demo runs the real daemon beside its subscriber.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace rptv {

/// Starts this very executable with other arguments; the child inherits stdout and stderr. The destructor ends the
/// child (SIGTERM, then waits). One thread.
class ChildProcess {
 public:
  /// `arguments` without the program's name. Throws Error(internal) when the process cannot be started.
  explicit ChildProcess(const std::vector<std::string>& arguments);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// True once it has ended; then exit_code() is its status (128 + signal when it was killed).
  bool ended() noexcept;
  int exit_code() const noexcept { return exit_code_; }
  void terminate() noexcept;
  /// Blocks until it has ended.
  int wait() noexcept;

 private:
  void reap(int options) noexcept;
  pid_t pid_ = -1;
  int exit_code_ = -1;
};

}  // namespace rptv
