// SPDX-License-Identifier: MIT
// The handler of SIGSEGV; it calls only what may be called there.
#include "tests/cuda_host/access_fault.hpp"

#include <signal.h>
#include <unistd.h>

#include <cstdio>

#include "tests/cuda_host/device_memory.hpp"
#include "tests/cuda_host/sanitizer_hooks.hpp"

namespace rptv::cuda_host {
namespace {

const DeviceMemory* watched = nullptr;
struct sigaction previous;

void explain(int, siginfo_t* info, void*) {
  char place[96];
  char text[256];
  if (watched->describe(info->si_addr, place, sizeof place) != nullptr) {
    const char* who =
        watched->is_open() ? "a kernel or a copy leaves its device memory" : "the host touches device memory";
    const int length = std::snprintf(text, sizeof text, "CUDA on the host: %s: %s\n", who, place);
    if (write(STDERR_FILENO, text, static_cast<std::size_t>(length)) < 0) _exit(70);
  }
  sigaction(SIGSEGV, &previous, nullptr);  // the access is repeated on return, and handled as before
}

}  // namespace

void explain_access_faults(const DeviceMemory& memory) {
  if (kAddressSanitizer) return;
  watched = &memory;
  struct sigaction handler = {};
  handler.sa_sigaction = &explain;
  handler.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigaction(SIGSEGV, &handler, &previous);
}

}  // namespace rptv::cuda_host
