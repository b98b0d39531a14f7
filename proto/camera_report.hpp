// SPDX-License-Identifier: MIT
// How each camera fares, as part of a status: to the wire, back, and as text.
#pragma once

#include <cstdint>
#include <string>

#include "core/clock.hpp"
#include "core/device_status.hpp"

namespace rapidptv {
class Camera;
}

namespace rptv {

/// Counters run since the daemon's start.
struct CameraReport {
  std::string name;  ///< as in losses
  DeviceStatus device;
  std::uint64_t delivered = 0;  ///< frames that it gave, whatever became of them
  ClockMapping clock;
  ClockSkew skew;  ///< against the first camera
};

void write_camera(const CameraReport& report, rapidptv::Camera& message);
/// A state that this reader does not know reads as `stopped`: a newer daemon may have more of them.
CameraReport read_camera(const rapidptv::Camera& message);

/// A JSON object.
std::string to_json(const CameraReport& report);
/// One line for people, without the driver's counters that are 0.
std::string to_line(const CameraReport& report);

}  // namespace rptv
