// SPDX-License-Identifier: MIT
// Trust in a device: before it is used, it must repeat what the CPU makes of an image.
#pragma once

#include <string>

#include "reconstruct/light_field/light_field_device.hpp"

namespace rptv {

/// Gives the device an image of scattered light of the plan's shape, several rounds, and compares all that it returns
/// with the CPU, bit for bit. Empty when it agrees, else what differs, in a few words. Set-up only; leaves the device
/// without limits.
std::string disagreement(LightFieldDevice& device, const LightFieldDevicePlan& plan);

}  // namespace rptv
