// SPDX-License-Identifier: MIT
// A camera's part of a status as protobuf, JSON and text.
#include "proto/camera_report.hpp"

#include <fmt/format.h>

#include "core/json.hpp"
#include "rapidptv.pb.h"

namespace rptv {

void write_camera(const CameraReport& report, rapidptv::Camera& message) {
  message.set_name(report.name);
  message.set_state(report.state);
  message.set_device(report.device);
  message.set_link(report.link);
  message.set_problem(report.problem);
  message.set_sessions(report.sessions);
  message.set_delivered(report.delivered);
  for (const NamedCount& counter : report.counters) {
    auto& entry = *message.add_counters();
    entry.set_name(counter.name);
    entry.set_count(counter.count);
  }
  if (!report.clock_mapped) return;
  auto& clock = *message.mutable_clock();
  clock.set_offset_ns(report.clock_offset_ns);
  clock.set_drift_ppm(report.clock_drift_ppm);
  clock.set_restarts(report.clock_restarts);
}

CameraReport read_camera(const rapidptv::Camera& message) {
  CameraReport report;
  report.name = message.name(), report.state = message.state(), report.device = message.device();
  report.link = message.link(), report.problem = message.problem();
  report.sessions = message.sessions(), report.delivered = message.delivered();
  for (const auto& counter : message.counters()) report.counters.push_back({counter.name(), counter.count()});
  report.clock_mapped = message.has_clock();
  report.clock_offset_ns = message.clock().offset_ns();
  report.clock_drift_ppm = message.clock().drift_ppm();
  report.clock_restarts = message.clock().restarts();
  return report;
}

std::string to_json(const CameraReport& report) {
  std::string counters;
  for (const NamedCount& counter : report.counters)
    counters += fmt::format("{}{}:{}", counters.empty() ? "" : ",", json_string(counter.name), counter.count);
  std::string clock = "null";
  if (report.clock_mapped)
    clock = fmt::format(R"({{"offset_ns":{},"drift_ppm":{},"restarts":{}}})", report.clock_offset_ns,
                        json_number(report.clock_drift_ppm), report.clock_restarts);
  return fmt::format(
      R"({{"name":{},"state":{},"device":{},"link":{},"problem":{},"sessions":{},"delivered":{},"counters":{{{}}},"clock":{}}})",
      json_string(report.name), json_string(report.state), json_string(report.device), json_string(report.link),
      json_string(report.problem), report.sessions, report.delivered, counters, clock);
}

std::string to_line(const CameraReport& report) {
  std::string line = fmt::format("camera {}", report.name);
  if (!report.state.empty()) line += " " + report.state;
  line += fmt::format(", {} frames", report.delivered);
  if (report.sessions > 1) line += fmt::format(", opened {} times", report.sessions);
  for (const NamedCount& counter : report.counters)
    if (counter.count != 0) line += fmt::format(", {} {}", counter.name, counter.count);
  if (report.clock_mapped && report.clock_restarts > 0)
    line += fmt::format(", its clock jumped {} times", report.clock_restarts);
  if (!report.link.empty()) line += "; " + report.link;
  if (!report.problem.empty()) line += "; " + report.problem;
  return line;
}

}  // namespace rptv
