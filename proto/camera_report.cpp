// SPDX-License-Identifier: MIT
// A camera's part of a status as protobuf, JSON and text.
#include "proto/camera_report.hpp"

#include <fmt/format.h>

#include "core/json.hpp"
#include "rapidptv.pb.h"

namespace rptv {
namespace {

double microseconds(std::int64_t ns) noexcept { return static_cast<double>(ns) * 1e-3; }

}  // namespace

void write_camera(const CameraReport& report, rapidptv::Camera& message) {
  message.set_name(report.name);
  message.set_state(std::string(name_of(report.device.state)));
  message.set_device(report.device.device);
  message.set_link(report.device.link);
  message.set_problem(report.device.problem);
  message.set_sessions(report.device.sessions);
  message.set_delivered(report.delivered);
  for (const DeviceCounter& counter : report.device.counters) {
    auto& entry = *message.add_counters();
    entry.set_name(counter.name);
    entry.set_count(counter.count);
  }
  if (report.skew.sets != 0) {
    auto& skew = *message.mutable_skew();
    skew.set_sets(report.skew.sets);
    skew.set_p50_ns(report.skew.p50_ns);
    skew.set_p99_ns(report.skew.p99_ns);
    skew.set_max_ns(report.skew.max_ns);
  }
  if (const Outage& outage = report.device.last_outage; outage.number > 0) {
    auto& entry = *message.mutable_last_outage();
    entry.set_number(outage.number), entry.set_first_frame(outage.first_frame);
    entry.set_duration_ns(static_cast<std::uint64_t>(outage.duration_ns)), entry.set_frames_due(outage.frames_due);
  }
  if (const DeviceReadings& readings = report.device.readings; !readings.values.empty()) {
    message.mutable_readings()->set_frame(readings.frame);
    for (const auto& [name, value] : readings.values) {
      auto& entry = *message.mutable_readings()->add_values();
      entry.set_name(name), entry.set_value(value);
    }
  }
  if (!report.clock.valid) return;
  auto& clock = *message.mutable_clock();
  clock.set_offset_ns(report.clock.offset_ns);
  clock.set_drift_ppm(report.clock.drift_ppm);
  clock.set_restarts(report.clock.restarts);
}

CameraReport read_camera(const rapidptv::Camera& message) {
  CameraReport report;
  DeviceStatus& device = report.device;
  for (std::size_t i = 0; i < kDeviceStateCount; ++i)
    if (name_of(static_cast<DeviceState>(i)) == message.state()) device.state = static_cast<DeviceState>(i);
  report.name = message.name(), report.delivered = message.delivered();
  device.device = message.device(), device.link = message.link(), device.problem = message.problem();
  device.sessions = message.sessions();
  for (const auto& counter : message.counters()) device.counters.push_back({counter.name(), counter.count()});
  const auto& outage = message.last_outage();
  device.last_outage = {outage.number(), outage.first_frame(), static_cast<std::int64_t>(outage.duration_ns()),
                        outage.frames_due()};
  device.readings.frame = message.readings().frame();
  for (const auto& reading : message.readings().values())
    device.readings.values.push_back({reading.name(), reading.value()});
  report.clock = {message.has_clock(), message.clock().offset_ns(), message.clock().drift_ppm(),
                  message.clock().restarts()};
  report.skew = {message.skew().sets(), message.skew().p50_ns(), message.skew().p99_ns(), message.skew().max_ns()};
  return report;
}

std::string to_json(const CameraReport& report) {
  std::string counters;
  for (const DeviceCounter& counter : report.device.counters)
    counters += fmt::format("{}{}:{}", counters.empty() ? "" : ",", json_string(counter.name), counter.count);
  std::string clock = "null";
  if (report.clock.valid)
    clock = fmt::format(R"({{"offset_ns":{},"drift_ppm":{},"restarts":{}}})", report.clock.offset_ns,
                        json_number(report.clock.drift_ppm), report.clock.restarts);
  std::string skew = "null";
  if (report.skew.sets != 0)
    skew = fmt::format(R"({{"sets":{},"p50_ns":{},"p99_ns":{},"max_ns":{}}})", report.skew.sets, report.skew.p50_ns,
                       report.skew.p99_ns, report.skew.max_ns);
  std::string outage = "null";
  if (const Outage& last = report.device.last_outage; last.number > 0)
    outage = fmt::format(R"({{"number":{},"first_frame":{},"duration_ns":{},"frames_due":{}}})", last.number,
                         last.first_frame, last.duration_ns, last.frames_due);
  std::string readings = "null";
  if (!report.device.readings.values.empty()) {
    std::string values;
    for (const auto& [name, value] : report.device.readings.values)
      values += fmt::format("{}{}:{}", values.empty() ? "" : ",", json_string(name), json_number(value));
    readings = fmt::format(R"({{"frame":{},"values":{{{}}}}})", report.device.readings.frame, values);
  }
  return fmt::format(
      R"({{"name":{},"state":{},"device":{},"link":{},"problem":{},"sessions":{},"delivered":{},"counters":{{{}}},"clock":{},"last_outage":{},"skew":{},"readings":{}}})",
      json_string(report.name), json_string(name_of(report.device.state)), json_string(report.device.device),
      json_string(report.device.link), json_string(report.device.problem), report.device.sessions, report.delivered,
      counters, clock, outage, skew, readings);
}

std::string to_line(const CameraReport& report) {
  const DeviceStatus& device = report.device;
  std::string line = fmt::format("camera {} {}, {} frames", report.name, name_of(device.state), report.delivered);
  if (device.sessions > 1) line += fmt::format(", opened {} times", device.sessions);
  for (const DeviceCounter& counter : device.counters)
    if (counter.count != 0) line += fmt::format(", {} {}", counter.name, counter.count);
  if (device.last_outage.number > 0)
    line += fmt::format(", gone for {:.1f} s until frame {}",
                        static_cast<double>(device.last_outage.duration_ns) * 1e-9, device.last_outage.first_frame);
  if (report.clock.valid && report.clock.restarts > 0)
    line += fmt::format(", its clock jumped {} times", report.clock.restarts);
  if (report.skew.sets != 0)
    line += fmt::format(", skew P50 {:.1f} P99 {:.1f} max {:.1f} us", microseconds(report.skew.p50_ns),
                        microseconds(report.skew.p99_ns), microseconds(report.skew.max_ns));
  for (const auto& [name, value] : device.readings.values) line += fmt::format(", {} {}", name, value);
  if (!device.link.empty()) line += "; " + device.link;
  if (!device.problem.empty()) line += "; " + device.problem;
  return line;
}

}  // namespace rptv
