// SPDX-License-Identifier: MIT
// The trial of a device that detects: from a set of images to their particle images.
#pragma once

#include "reconstruct/detection/detect_device.hpp"
#include "reconstruct/device_trial.hpp"

namespace rptv {

/// Gives the device painted particle images in the plan's shapes, as bright over each background as its limits ask, and
/// compares all that it returns with the CPU's detectors, which take `threads`. Set-up only.
DeviceTrial try_device(DetectDevice& device, const DetectDevicePlan& plan, std::size_t threads);

}  // namespace rptv
