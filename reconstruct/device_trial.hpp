// SPDX-License-Identifier: MIT
// Trust in a device: before it is used, it must repeat what the CPU makes of a test image, and is timed beside it.
#pragma once

#include <algorithm>
#include <chrono>
#include <string>

namespace rptv {

/// How a device did beside the CPU: the same work on both, the shortest of some runs, ms.
struct DeviceTrial {
  std::string differs;  ///< empty: it agrees bit for bit; else where it does not, in a few words
  double cpu_ms = 0, device_ms = 0;
};

/// Times both, in turns.
template <class Cpu, class Device>
void time_trial(DeviceTrial& trial, const Cpu& cpu, const Device& device) {
  constexpr int kRuns = 5;
  const auto ms = [](const auto& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  };
  for (int run = 0; run < kRuns; ++run) {
    const double cpu_ms = ms(cpu), device_ms = ms(device);
    trial.cpu_ms = run == 0 ? cpu_ms : std::min(trial.cpu_ms, cpu_ms);
    trial.device_ms = run == 0 ? device_ms : std::min(trial.device_ms, device_ms);
  }
}

}  // namespace rptv
