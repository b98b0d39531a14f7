// SPDX-License-Identifier: MIT
// Opens the cameras of the list and passes start, stop and status on to each.
#include "acquisition/aravis_source.hpp"

#include "acquisition/aravis_camera.hpp"
#include "core/error.hpp"

namespace rptv {

AravisSource::AravisSource(const AravisSettings& settings, std::size_t pool_frames) {
  if (settings.cameras.empty())
    throw Error(ExitCode::configuration,
                "aravis.cameras is empty; name the cameras by address, for instance cameras = [\"192.168.1.10\"]");
  if (!settings.region.empty() && settings.region.size() != 4)
    throw Error(ExitCode::configuration, "aravis.region has " + std::to_string(settings.region.size()) +
                                             " numbers; give four: x, y, width, height");
  if (settings.trigger == "software" && settings.rate_hz <= 0)
    throw Error(ExitCode::configuration,
                "aravis.trigger = 'software' without rate_hz; set rate_hz to how often the cameras are to be fired");
  for (const std::string& name : settings.cameras) {
    const auto number = static_cast<std::uint32_t>(cameras_.size());
    cameras_.push_back(std::make_unique<AravisCamera>(settings, name, number, pool_frames));
    infos_.push_back(cameras_.back()->info());
    period_ns_ = std::max(period_ns_, cameras_.back()->period_ns());
  }
}

AravisSource::~AravisSource() { stop(); }

void AravisSource::start(FrameSink& sink) {
  for (auto& camera : cameras_) camera->start(sink);
}

void AravisSource::stop() noexcept {
  for (auto& camera : cameras_) camera->ask_to_stop();  // so that they wait for absent cameras at the same time
  for (auto& camera : cameras_) camera->stop();
}

std::vector<DeviceStatus> AravisSource::device_status() const {
  std::vector<DeviceStatus> all;
  for (const auto& camera : cameras_) all.push_back(camera->status());
  return all;
}

}  // namespace rptv
