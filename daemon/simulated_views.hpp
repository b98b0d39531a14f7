// SPDX-License-Identifier: MIT
// Writes a simulated run of a rig of several cameras, with the truth in tables and in the tracking challenge's files.
#pragma once

#include <cstdint>
#include <filesystem>

#include "daemon/simulated_run.hpp"

namespace rptv {

/// Writes into the folder: frames/cam0/frame_00000.png … for every camera and frames/frames.csv (frame,t);
/// cameras.toml, the rig; truth.csv, a tracks table with in_view (whole on the sensor of three cameras, or of all of
/// two) and x0_px,y0_px,x1_px,… behind it; truth/points_00000.txt, X Y Z x1 y1 … of every frame; scenario.toml. Pixels
/// that a camera cannot see are NaN. Files of an earlier run are replaced. The same scenario gives the same files
/// whatever the number of threads. `rays` of the report is 0. Throws Error.
SimulatedRunReport write_simulated_views(const ScenarioSettings& scenario, const SimulatedRunOptions& options);

}  // namespace rptv
