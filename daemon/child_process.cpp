// SPDX-License-Identifier: MIT
// posix_spawn and waitpid behind daemon/child_process.hpp.
#include "daemon/child_process.hpp"

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>

#include "core/error.hpp"

namespace rptv {

ChildProcess::ChildProcess(const std::vector<std::string>& arguments) {
  std::vector<std::string> words{"rapidptv"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  if (const int error = posix_spawn(&pid_, "/proc/self/exe", nullptr, nullptr, argv.data(), environ); error != 0) {
    pid_ = -1;
    throw Error(ExitCode::internal, std::string("cannot start a second rapidptv: ") + std::strerror(error));
  }
}

ChildProcess::~ChildProcess() {
  if (ended()) return;
  terminate();
  wait();
}

bool ChildProcess::ended() noexcept {
  if (pid_ > 0) reap(WNOHANG);
  return pid_ <= 0;
}

void ChildProcess::terminate() noexcept {
  if (pid_ > 0) kill(pid_, SIGTERM);
}

int ChildProcess::wait() noexcept {
  while (pid_ > 0) reap(0);
  return exit_code_;
}

void ChildProcess::reap(int options) noexcept {
  int status = 0;
  if (waitpid(pid_, &status, options) != pid_) return;
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  pid_ = -1;
}

}  // namespace rptv
