// SPDX-License-Identifier: MIT
// The trial of a light-field device: from an image to its particles.
#pragma once

#include "reconstruct/device_trial.hpp"
#include "reconstruct/light_field/light_field_device.hpp"

namespace rptv {

/// Gives the device an image of scattered light of the plan's shape, several rounds, and compares all that it returns
/// with the CPU. Set-up only; leaves the device with limits that are not those of the camera.
DeviceTrial try_device(LightFieldDevice& device, const LightFieldDevicePlan& plan);

}  // namespace rptv
