// SPDX-License-Identifier: MIT
// Starting, stopping and killing the test camera's process.
#include "tests/acquisition/camera_process.hpp"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

namespace rptv {

CameraProcess::CameraProcess(const std::string& address, std::uint64_t session, const std::string& serial)
    : truth_(SharedTruth::make(place_.file("truth"))) {
  const char* binary = std::getenv("GVSP_CAMERA");
  if (binary == nullptr) throw std::runtime_error("GVSP_CAMERA does not name the test camera's binary");
  const std::string sequence = std::to_string(session << 32), file = place_.file("truth").string();
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe for the test camera");
  pid_ = fork();
  if (pid_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    dup2(ends[1], STDOUT_FILENO);
    execl(binary, binary, address.c_str(), serial.c_str(), sequence.c_str(), file.c_str(), nullptr);
    _exit(127);
  }
  said_.emplace(ends[0]);
  close(ends[1]);
  if (hears_word()) return;
  end(SIGKILL);
  throw std::runtime_error("the test camera at " + address + " does not start");
}

bool CameraProcess::hears_word() const {
  pollfd word{said_->get(), POLLIN, 0};
  char text[8];
  return poll(&word, 1, 60'000) > 0 && read(said_->get(), text, sizeof text) > 0;
}

void CameraProcess::rest() {
  ::kill(pid_, SIGUSR1);
  if (!hears_word()) throw std::runtime_error("the test camera does not come to rest");
}

void CameraProcess::end(int signal) {
  if (pid_ < 0) return;
  ::kill(pid_, signal);
  ::kill(pid_, SIGCONT);
  waitpid(pid_, nullptr, 0);
  pid_ = -1;
}

void CameraProcess::freeze() {
  ::kill(pid_, SIGSTOP);
  waitpid(pid_, nullptr, WUNTRACED);  // it has stopped
}

void CameraProcess::thaw() { ::kill(pid_, SIGCONT); }

}  // namespace rptv
