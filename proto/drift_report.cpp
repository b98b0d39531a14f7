// SPDX-License-Identifier: MIT
// Disparities of a status as protobuf, JSON and text.
#include "proto/drift_report.hpp"

#include <fmt/format.h>

#include "core/json.hpp"
#include "rapidptv.pb.h"

namespace rptv {

void write_drift(const DriftReport& report, rapidptv::Drift& message) {
  message.set_looked_at(report.looked_at), message.set_passed_over(report.passed_over);
  for (const DisparityReport& camera : report.cameras) {
    auto& entry = *message.add_cameras();
    entry.set_camera(camera.camera), entry.set_parts(camera.parts), entry.set_votes(camera.votes);
    entry.set_median_px(camera.median_px), entry.set_worst_px(camera.worst_px);
    entry.set_worst_x_mm(camera.worst_at_mm[0]), entry.set_worst_y_mm(camera.worst_at_mm[1]);
    entry.set_worst_z_mm(camera.worst_at_mm[2]);
  }
}

DriftReport read_drift(const rapidptv::Drift& message) {
  DriftReport report{true, message.looked_at(), message.passed_over(), {}};
  for (const auto& entry : message.cameras())
    report.cameras.push_back({entry.camera(),
                              entry.parts(),
                              entry.votes(),
                              entry.median_px(),
                              entry.worst_px(),
                              {entry.worst_x_mm(), entry.worst_y_mm(), entry.worst_z_mm()}});
  return report;
}

std::string to_json(const DriftReport& report) {
  if (!report.watched) return "null";
  std::string cameras;
  for (const DisparityReport& camera : report.cameras) {
    const auto& [x, y, z] = camera.worst_at_mm;
    cameras += fmt::format(
        R"({}{{"camera":{},"parts":{},"votes":{},"median_px":{},"worst_px":{},"worst_at_mm":[{},{},{}]}})",
        cameras.empty() ? "" : ",", json_string(camera.camera), camera.parts, json_number(camera.votes),
        json_number(camera.median_px), json_number(camera.worst_px), json_number(x), json_number(y), json_number(z));
  }
  return fmt::format(R"({{"looked_at":{},"passed_over":{},"cameras":[{}]}})", report.looked_at, report.passed_over,
                     cameras);
}

std::string to_line(const DriftReport& report) {
  std::string line = "disparity";
  for (const DisparityReport& camera : report.cameras)
    line += camera.parts == 0 ? fmt::format(" {} unknown", camera.camera)
                              : fmt::format(" {} {:.2f} px", camera.camera, camera.median_px);
  return report.cameras.empty() ? line + " not known yet" : line;
}

}  // namespace rptv
