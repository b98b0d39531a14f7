// SPDX-License-Identifier: MIT
// Trust in a device: before it is used, it must repeat what the CPU makes of an image, and is timed beside it.
#pragma once

#include <string>

#include "reconstruct/light_field/light_field_device.hpp"

namespace rptv {

/// How a device did beside the CPU: from an image to its particles, the shortest of some runs, ms.
struct DeviceTrial {
  std::string differs;  ///< empty: it agrees bit for bit; else where it does not, in a few words
  double cpu_ms = 0, device_ms = 0;
};

/// Gives the device an image of scattered light of the plan's shape, several rounds, and compares all that it returns
/// with the CPU. Set-up only; leaves the device with limits that are not those of the camera.
DeviceTrial try_device(LightFieldDevice& device, const LightFieldDevicePlan& plan);

}  // namespace rptv
