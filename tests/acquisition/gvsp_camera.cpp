// SPDX-License-Identifier: MIT
// The test camera as a process of its own, which can be killed, stopped and put behind a network that goes down.
#include <csignal>
#include <cstdlib>
#include <iostream>

#include "tests/acquisition/gvsp_device.hpp"
#include "tests/acquisition/shared_truth.hpp"

/// gvsp_camera ADDRESS SERIAL LAST_SEQUENCE TRUTH_FILE: says "ready" on standard output, and "rests" when it was
/// told to by SIGUSR1. Runs until SIGTERM.
int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "usage: gvsp_camera ADDRESS SERIAL LAST_SEQUENCE TRUTH_FILE\n";
    return 64;
  }
  sigset_t told;
  sigemptyset(&told);
  sigaddset(&told, SIGTERM);
  sigaddset(&told, SIGUSR1);
  pthread_sigmask(SIG_BLOCK, &told, nullptr);  // the camera's thread inherits it
  const rptv::SharedTruth truth = rptv::SharedTruth::open(argv[4]);
  rptv::GvspDevice device(argv[1], {}, {argv[2], std::strtoull(argv[3], nullptr, 10)}, &*truth);
  std::cout << "ready\n" << std::flush;
  for (int signal = 0; sigwait(&told, &signal) == 0 && signal == SIGUSR1;) {
    device.rest();
    std::cout << "rests\n" << std::flush;
  }
  return 0;
}
