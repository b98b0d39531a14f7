// SPDX-License-Identifier: MIT
// How a camera and its driver fare, for status messages and tools: in the driver's own words and counts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rptv {

enum class DeviceState : std::uint8_t {
  connecting,  ///< the device is looked for, opened and set up
  streaming,   ///< frames may come
  lost,        ///< it stopped answering; the source tries again by itself
  stopped,     ///< before start() and after stop()
  count_       ///< number of states, not a state
};
inline constexpr std::size_t kDeviceStateCount = static_cast<std::size_t>(DeviceState::count_);

constexpr std::string_view name_of(DeviceState state) noexcept {
  constexpr std::array<std::string_view, kDeviceStateCount> kNames{"connecting", "streaming", "lost", "stopped"};
  return kNames[static_cast<std::size_t>(state)];
}

/// One of the driver's counters: "n_missing_packets".
struct DeviceCounter {
  std::string name;
  std::uint64_t count = 0;
};

/// The device was gone for a while: an event, which a reader that comes late still finds.
struct Outage {
  std::uint64_t number = 0;       ///< counts from 1; 0: none so far
  std::uint64_t first_frame = 0;  ///< index of the first frame afterwards
  std::int64_t duration_ns = 0;   ///< from the last frame before to that one
  std::uint64_t frames_due = 0;   ///< by the frame period, as counted under `source_outage`
  bool operator==(const Outage&) const = default;
};

/// What the camera measured with one image: "ExposureTime", in the camera's unit.
struct DeviceReadings {
  struct Value {
    std::string name;
    double value = 0;
    bool operator==(const Value&) const = default;
  };
  std::uint64_t frame = 0;  ///< index of the image
  std::vector<Value> values;
  bool operator==(const DeviceReadings&) const = default;
};

struct DeviceStatus {
  DeviceState state = DeviceState::stopped;
  std::string device;          ///< vendor, model, serial and address, as far as they are known
  std::string link;            ///< what was negotiated: packet size, buffers, pixel format, priority; one line
  std::string problem;         ///< one line with the next step; empty while all is well
  std::uint64_t sessions = 0;  ///< times that it was opened and started
  std::vector<DeviceCounter> counters;
  Outage last_outage;
  DeviceReadings readings;
};

}  // namespace rptv
