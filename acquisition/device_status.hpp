// SPDX-License-Identifier: MIT
// How a camera and its driver fare, for status messages and tools: in the driver's own words and counts.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rptv {

enum class DeviceState : std::uint8_t {
  connecting,  ///< the device is looked for, opened and set up
  streaming,   ///< frames may come
  lost,        ///< it stopped answering; the source tries again by itself
  stopped      ///< before start() and after stop()
};

/// One of the driver's counters: "n_missing_packets".
struct DeviceCounter {
  std::string name;
  std::uint64_t count = 0;
};

struct DeviceStatus {
  DeviceState state = DeviceState::stopped;
  std::string device;          ///< vendor, model, serial and address, as far as they are known
  std::string link;            ///< what was negotiated: packet size, buffers, pixel format, priority; one line
  std::string problem;         ///< one line with the next step; empty while all is well
  std::uint64_t sessions = 0;  ///< times that it was opened and started
  std::vector<DeviceCounter> counters;
};

}  // namespace rptv
