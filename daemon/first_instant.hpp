// SPDX-License-Identifier: MIT
// What the first images of a recording by several cameras say against a run with them.
#pragma once

#include <string>
#include <vector>

#include "daemon/config.hpp"

namespace rptv {

/// Lines with the next step: for each of the rig's cameras that has no images; for each whose first image is empty or
/// saturated; and if there is none of those, one when the particle images of the first instant do not meet in space, as
/// with swapped or moved cameras (Meeting). Nothing for a live source or a light field. Matches that instant once with
/// a stage of its own, by method "detections" on the CPU. Throws Error for images that cannot be read and as
/// make_reconstructor() does. Main thread.
std::vector<std::string> doubts_of_first_instant(const Config& config);

}  // namespace rptv
