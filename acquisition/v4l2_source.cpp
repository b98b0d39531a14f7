// SPDX-License-Identifier: MIT
// V4L2 cameras and their threads.
#include "acquisition/v4l2_source.hpp"

#include <pthread.h>

#include "acquisition/v4l2_camera.hpp"
#include "core/error.hpp"

namespace rptv {

V4l2Source::V4l2Source(const V4l2Settings& settings, std::size_t pool_frames, V4l2System* system) {
  if (settings.devices.empty())
    throw Error(ExitCode::configuration,
                "v4l2.devices is empty; name the cameras' nodes, for instance [\"/dev/video0\"]");
  for (const std::string& path : settings.devices) {
    const auto number = static_cast<std::uint32_t>(running_.size());
    running_.push_back(
        std::make_unique<V4l2Camera>(system != nullptr ? *system : real_, path, settings, number, pool_frames));
    cameras_.push_back(running_.back()->info());
  }
}

V4l2Source::~V4l2Source() { stop(); }

void V4l2Source::start(FrameSink& sink) {
  try {
    for (auto& camera : running_) camera->begin(sink);
  } catch (...) {
    for (auto& camera : running_) camera->close();  // the sink may go before this object does
    throw;
  }
  for (std::size_t i = 0; i < running_.size(); ++i) {
    threads_.emplace_back([&sink, &camera = *running_[i]] { camera.run(sink); });
    pthread_setname_np(threads_.back().native_handle(), ("rptv-v4l2-" + std::to_string(i)).c_str());
  }
}

void V4l2Source::stop() noexcept {
  for (auto& camera : running_) camera->end();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

std::int64_t V4l2Source::nominal_period_ns() const noexcept { return running_.front()->period_ns(); }

std::vector<DeviceStatus> V4l2Source::device_status() const {
  std::vector<DeviceStatus> all;
  for (const auto& camera : running_) all.push_back(camera->status());
  return all;
}

}  // namespace rptv
