// SPDX-License-Identifier: MIT
// One GenICam camera's life: opened, streaming, lost, opened again.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "acquisition/aravis_settings.hpp"
#include "acquisition/source.hpp"

namespace rptv {

/// Set-up, start, stop: main thread. status(): any thread, takes a lock that no receiving thread takes.
class AravisCamera {
 public:
  /// Opens it once, so that info() is known. Throws Error as AravisSource does.
  AravisCamera(const AravisSettings& settings, const std::string& name, std::uint32_t number, std::size_t pool_frames);
  ~AravisCamera();

  CameraInfo info() const;
  std::int64_t period_ns() const noexcept;
  void start(FrameSink& sink);
  void ask_to_stop() noexcept;
  /// Takes up to 6 s when the camera is gone.
  void stop() noexcept;
  DeviceStatus status() const;

 private:
  struct Life;  // aravis_camera.cpp
  std::unique_ptr<Life> life_;
};

}  // namespace rptv
