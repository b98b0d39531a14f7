// SPDX-License-Identifier: MIT
// GenICam cameras (GigE Vision, USB3 Vision) as a Source, through Aravis.
#pragma once

#include <memory>
#include <vector>

#include "acquisition/aravis_settings.hpp"
#include "acquisition/source.hpp"

namespace rptv {

class AravisCamera;

/// Frames come in Aravis' receiving thread of each camera, straight into the sink's slots: nothing is copied. A camera
/// that stops answering is opened again by a thread of its own, with the same settings, at once and then every 300 ms;
/// its indices go on. exposure_end_ns is the camera's own time stamp; exposure_end_host_ns and arrival_ns are the
/// moment when Aravis had the whole image. Nothing of ours allocates per frame; Aravis and GLib may.
class AravisSource final : public Source {
 public:
  /// Opens and sets up the cameras. `pool_frames` are the slots per camera that the sink will have (≥ 4); half of them,
  /// at most 32, lie with the driver. Throws Error: configuration, unavailable (camera absent or taken).
  AravisSource(const AravisSettings& settings, std::size_t pool_frames);
  ~AravisSource() override;

  const std::vector<CameraInfo>& cameras() const noexcept override { return infos_; }
  void start(FrameSink& sink) override;
  /// Close a lossless sink first: a camera that waits in its claim() hears nothing else.
  void stop() noexcept override;
  std::int64_t nominal_period_ns() const noexcept override { return period_ns_; }
  std::string failure() const override { return {}; }
  std::vector<DeviceStatus> device_status() const override;

 private:
  std::vector<std::unique_ptr<AravisCamera>> cameras_;
  std::vector<CameraInfo> infos_;
  std::int64_t period_ns_ = 0;
};

}  // namespace rptv
