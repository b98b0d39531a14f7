// SPDX-License-Identifier: MIT
// The detectors of a rig on a CUDA device.
#pragma once

#include "reconstruct/detection/detect_device.hpp"

namespace rptv {

/// A stream per camera: images go up while others are worked on. On the device that is current when it is made. In a
/// build without CUDA it throws Error(unavailable), as where the device has no room.
std::unique_ptr<DetectDevice> make_detect_cuda(const DetectDevicePlan& plan);

}  // namespace rptv
