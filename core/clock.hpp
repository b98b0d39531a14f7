// SPDX-License-Identifier: MIT
// Clocks: which one a time was read from, and the host's monotonic time.
#pragma once

#include <chrono>
#include <cstdint>

namespace rptv {

/// The clock that a time stamp was read from. Times of different clocks must never be subtracted.
enum class ClockId : std::uint8_t {
  host_monotonic = 0,  ///< CLOCK_MONOTONIC of this machine
  device = 1,          ///< the camera's own counter
  ptp = 2,             ///< camera clock disciplined by PTP
  recording = 3,       ///< time column of a recording or of frames.csv
  nominal = 4,         ///< frame index / stated rate: nobody measured it
};

/// Nanoseconds of CLOCK_MONOTONIC. Any thread; never fails.
inline std::int64_t host_now_ns() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// From a device's clock to CLOCK_MONOTONIC: host time = device time + offset, the offset growing by `drift_ppm` µs per
/// second.
struct ClockMapping {
  bool valid = false;          ///< at least one frame was mapped
  std::int64_t offset_ns = 0;  ///< at the last frame; bent by at most the least delay between exposure and arrival
  double drift_ppm = 0;        ///< positive: the device's clock runs slow; 0 until two seconds were seen
  std::uint64_t restarts = 0;  ///< jumps of the device's clock after which the fit began anew
};

/// How far one camera's times lie from the first camera's in the sets so far, on the clock that pairs them.
struct ClockSkew {
  std::uint64_t sets = 0;
  std::int64_t p50_ns = 0, p99_ns = 0, max_ns = 0;  ///< absolute values
};

}  // namespace rptv
