// SPDX-License-Identifier: MIT
// V4L2 cameras as a Source.
#pragma once

#include <memory>
#include <thread>
#include <vector>

#include "acquisition/source.hpp"
#include "acquisition/v4l2_settings.hpp"
#include "acquisition/v4l2_system.hpp"

namespace rptv {

class V4l2Camera;

/// One thread per camera waits for the driver and delivers what it wrote: straight into the sink's slots where driver
/// and format allow it (v4l2.memory), else copied or unpacked once. Indices follow the driver's sequence numbers, so
/// its drops are gaps. A device that is lost, or whose source changed, is opened again when it is plugged in, and now
/// and then, until it is back with the same shape; indices go on, further by what it will have missed at its period, so
/// that it is a gap. Times are the driver's, of CLOCK_MONOTONIC for nearly every driver. Nothing allocates, locks or
/// throws per frame.
class V4l2Source final : public Source {
 public:
  /// Opens and sets up every device. Throws Error(configuration, unavailable, permission). `pool_frames`: slots per
  /// camera of the sink to come, of which up to half lie with the driver. `system` must outlive this object; null: the
  /// real one.
  V4l2Source(const V4l2Settings& settings, std::size_t pool_frames, V4l2System* system = nullptr);
  ~V4l2Source() override;

  const std::vector<CameraInfo>& cameras() const noexcept override { return cameras_; }
  void start(FrameSink& sink) override;
  /// Close a lossless sink first: a camera that waits in its claim() hears nothing else.
  void stop() noexcept override;
  std::int64_t nominal_period_ns() const noexcept override;
  std::string failure() const override { return {}; }  // a lost device may come back: see device_status()
  std::vector<DeviceStatus> device_status() const override;

 private:
  V4l2System real_;
  std::vector<CameraInfo> cameras_;
  std::vector<std::unique_ptr<V4l2Camera>> running_;
  std::vector<std::thread> threads_;
};

}  // namespace rptv
