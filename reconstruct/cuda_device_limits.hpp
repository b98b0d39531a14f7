// SPDX-License-Identifier: MIT
// What a device can do at most, by its own word.
#pragma once

#include <string>

namespace rptv {

/// Clocks are the highest that the driver names; 0: it names none, and what follows from it is 0, too.
struct CudaDeviceLimits {
  std::string name;
  int toolkit = 0, driver = 0;  ///< 1000·major + 10·minor
  int multiprocessors = 0, memory_bus_bits = 0;
  double clock_hz = 0, memory_clock_hz = 0;

  /// Both edges of the memory's clock carry a bus width.
  double memory_bytes_per_s() const { return 2 * memory_clock_hz * memory_bus_bits / 8; }
  /// A multiprocessor's shared memory has 32 banks, and a bank takes an increment a clock.
  double increments_per_s() const { return 32 * clock_hz * multiprocessors; }
};

/// Of the device that is current. Set-up only. Throws Error(unavailable).
CudaDeviceLimits ask_cuda_device_limits();

}  // namespace rptv
