// SPDX-License-Identifier: MIT
// The cameras of a multi-view scenario; among them those of the first Lagrangian particle tracking challenge.
#pragma once

#include "calibration/cameras/rig.hpp"
#include "simulation/scenario.hpp"

namespace rptv {

/// Four cameras 600 mm from the middle of a volume of 100 x 50 x 30 mm, which they see under ±30° about y and ±10°
/// about x; pinholes of 100 mm before 1920 x 1200 pixels of 10 um (Leclaire et al. 2021, first challenge on Lagrangian
/// particle tracking; Δt 600 us). `sensor_part` of the width and height, about the same axis: the same particles per
/// pixel from that part of the volume. Names cam0 to cam3.
Rig challenge_rig(double sensor_part = 1);

/// The scenario's cameras. Throws Error as read_rig() does.
Rig rig_of(const ScenarioSettings& scenario);

/// The scenario with what the rig decides: camera.width_px and height_px of its first camera, the lit box' part,
/// seeding.particles by views.per_pixel.
ScenarioSettings fitted_to_rig(ScenarioSettings scenario, const Rig& rig);

}  // namespace rptv
