// SPDX-License-Identifier: MIT
// Opens a camera, writes its settings and reads what it then is; for the aravis_*.cpp files only.
#pragma once

#include <cstdint>
#include <string>

#include "acquisition/aravis_handle.hpp"
#include "acquisition/aravis_settings.hpp"
#include "acquisition/pixel_format.hpp"
#include "core/image.hpp"

namespace rptv {

/// What an opened camera is and will send.
struct AravisSetup {
  std::string device;   ///< vendor, model, serial, address or name it was opened by
  std::string address;  ///< of a GigE Vision camera, dotted; else empty
  const PixelFormat* format = nullptr;
  ImageShape shape;
  std::size_t payload_bytes = 0;       ///< of one image as it is sent
  std::size_t bytes_behind_image = 0;  ///< chunk data among them
  std::int64_t period_ns = 0;          ///< 0: unknown, or triggered by others
  std::uint32_t packet_size = 0;       ///< 0: not GigE Vision
  double exposure_us = 0;              ///< 0: the camera does not say
  bool wide_ids = false;
  std::string text() const;  ///< "Mono8 1920 x 1200 px, exposure 500 us, packets of 8228 bytes"
};

/// Opening an absent camera blocks for 2.5 s. Throws Error(unavailable) when it is absent or does not answer.
CameraHandle open_camera(const std::string& name);

/// Throws Error: configuration for a value that the camera refuses, unavailable when another program controls it or it
/// stops answering. Not for real-time threads.
AravisSetup set_up_camera(ArvCamera* camera, const std::string& name, const AravisSettings& settings);

}  // namespace rptv
