// SPDX-License-Identifier: MIT
// What a GPU may do of the multi-view chain: the particle images of all cameras.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "core/image.hpp"
#include "reconstruct/dark_pixels.hpp"
#include "reconstruct/detection/detections.hpp"
#include "reconstruct/detection/detector_settings.hpp"

namespace rptv {

/// The detectors of a rig on another processor, with the same results bit for bit. Set-up takes all memory. One thread.
class DetectDevice {
 public:
  virtual ~DetectDevice() = default;

  /// Detector::detect() for one image per camera, all at once: replaces what is in `seen`. Images without data leave
  /// their list empty. Returns when all are done; false when the device fails, and the lists are then of no account.
  virtual bool detect(std::span<const ImageView> images, std::span<Detections> seen) noexcept = 0;
};

/// What a device is set up for; one shape and one background per camera. They live as long as the call.
struct DetectDevicePlan {
  const DetectorSettings& settings;
  std::span<const ImageShape> shapes;
  std::span<const DarkPixels> dark;
};

/// Throws Error(unavailable) when the device cannot be used.
using MakeDetectDevice = std::function<std::unique_ptr<DetectDevice>(const DetectDevicePlan&)>;

/// Which setting only the CPU's detector has, and what to set instead; empty: none.
std::string only_on_cpu(const DetectorSettings& settings);

}  // namespace rptv
