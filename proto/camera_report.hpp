// SPDX-License-Identifier: MIT
// How each camera fares, as part of a status: to the wire, back, and as text.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rapidptv {
class Camera;
}

namespace rptv {

/// One of the driver's counters since start, in the driver's own name.
struct NamedCount {
  std::string name;
  std::uint64_t count = 0;
};

/// Counters run since the daemon's start.
struct CameraReport {
  std::string name;    ///< as in losses
  std::string state;   ///< "connecting", "streaming", "lost", "stopped"; empty for a recording
  std::string device;  ///< vendor, model, serial and address, as far as they are known
  std::string link;    ///< what was negotiated: pixel format, packet size, …
  std::string problem;
  std::uint64_t sessions = 0;   ///< times that it was opened and started
  std::uint64_t delivered = 0;  ///< frames that it gave, whatever became of them
  std::vector<NamedCount> counters;
  bool clock_mapped = false;         ///< its clock is mapped to CLOCK_MONOTONIC by the next two
  std::int64_t clock_offset_ns = 0;  ///< host − device, at its last frame
  double clock_drift_ppm = 0;        ///< by which the offset grows
  std::uint64_t clock_restarts = 0;  ///< jumps of the device's clock
};

void write_camera(const CameraReport& report, rapidptv::Camera& message);
CameraReport read_camera(const rapidptv::Camera& message);

/// A JSON object.
std::string to_json(const CameraReport& report);
/// One line for people, without the driver's counters that are 0.
std::string to_line(const CameraReport& report);

}  // namespace rptv
