// SPDX-License-Identifier: MIT
// How well the cameras of a rig still agree, as part of a status: to the wire, back, and as text.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace rapidptv {
class Drift;
}

namespace rptv {

/// A camera's disparities: projections of triangulated particles less their images.
struct DisparityReport {
  std::string camera;
  std::uint32_t parts = 0;              ///< of the volume, whose particles agree on a disparity
  double votes = 0;                     ///< particles that do, older ones faded
  double median_px = 0;                 ///< length, over these parts; 0 without any
  double worst_px = 0;                  ///< of the part with the largest
  std::array<double, 3> worst_at_mm{};  ///< where that part's particles are, rig's frame
};

struct DriftReport {
  bool watched = false;
  std::uint64_t looked_at = 0, passed_over = 0;  ///< frame sets since start that had a say, and that had none
  std::vector<DisparityReport> cameras;          ///< in the source's order; empty before the first look
};

void write_drift(const DriftReport& report, rapidptv::Drift& message);
DriftReport read_drift(const rapidptv::Drift& message);

/// A JSON object, or null where nobody watches.
std::string to_json(const DriftReport& report);
/// One line for people.
std::string to_line(const DriftReport& report);

}  // namespace rptv
