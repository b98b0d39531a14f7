// SPDX-License-Identifier: MIT
// Episodes of silence, and the likely cause of one from what the driver says.
#include "acquisition/silence_alarm.hpp"

#include <cstdio>

namespace rptv {
namespace {

std::uint64_t missing_of(const DeviceStatus* device) {
  std::uint64_t sum = 0;
  if (device == nullptr) return sum;
  for (const DeviceCounter& counter : device->counters)
    if (counter.name.find("missing") != std::string::npos) sum += counter.count;
  return sum;
}

// The most certain cause first.
std::string cause_of(const DeviceStatus* device, bool packets_missing, bool had_frames) {
  if (device == nullptr) return "the source is slow, or waits; see its settings";
  if (!device->problem.empty()) return device->problem;
  if (device->state == DeviceState::lost) return "the device is lost; check its cable and power";
  if (device->state == DeviceState::connecting) return "the device is not connected yet; check its address and power";
  if (packets_missing)
    return "the driver counts missing packets: too little bandwidth, or a firewall drops them; run `rapidptv doctor`";
  if (device->link.find("trigger software") != std::string::npos)
    return "it is fired by software and sends nothing; check that its exposure fits into the period of rate_hz";
  if (device->link.find("rigger") != std::string::npos)
    return "a trigger is configured and none comes; check its line and its generator";
  if (had_frames) return "the device answers and sends nothing; check its trigger, its cable and the link";
  return "no packet ever came: wrong network interface, or a firewall; run `rapidptv doctor`";
}

std::string seconds(std::int64_t ns) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", static_cast<double>(ns) * 1e-9);
  return text;
}

}  // namespace

SilenceAlarm::SilenceAlarm(std::vector<std::string> names, std::int64_t limit_ns) : limit_ns_(limit_ns) {
  for (std::string& name : names) {
    cameras_.emplace_back();
    cameras_.back().name = std::move(name);
  }
}

std::string SilenceAlarm::look(std::uint32_t camera, std::int64_t now_ns, std::uint64_t delivered,
                               const DeviceStatus* device) {
  Camera& mine = cameras_[camera];
  const std::uint64_t missing = missing_of(device);
  const std::int64_t silent_ns = now_ns - mine.last_frame_ns;
  if (!mine.seen || delivered != mine.delivered) {
    const bool was_silent = !mine.warning.empty();
    mine.seen = true;
    mine.delivered = delivered;
    mine.missing = missing;
    mine.last_frame_ns = now_ns;
    mine.warning.clear();
    return was_silent ? mine.name + ": frames come again after " + seconds(silent_ns) + " s" : std::string{};
  }
  if (silent_ns < limit_ns_) return {};
  const bool begins = mine.warning.empty();
  mine.warning = mine.name + ": no frame for " + seconds(silent_ns) +
                 " s: " + cause_of(device, missing > mine.missing, delivered != 0);
  return begins ? mine.warning : std::string{};
}

}  // namespace rptv
