// SPDX-License-Identifier: MIT
// The trial of a device that matches: from lists of particle images to particles.
#pragma once

#include "reconstruct/device_trial.hpp"
#include "reconstruct/multi_view/match_device.hpp"

namespace rptv {

/// Points of the volume as the plan's cameras see them, half as many as max_detections and 1000 at most, through
/// MultiView with the device and without: the particles must be the same, bit for bit. One in fifty may be another, for
/// the choice among rivals. Then both are timed. Set-up only. Throws Error.
DeviceTrial try_device(MatchDevice& device, const MatchDevicePlan& plan);

}  // namespace rptv
