// SPDX-License-Identifier: MIT
// What the first images of a recording by several cameras say against a run with them.
#pragma once

#include <string>
#include <vector>

#include "daemon/config.hpp"
#include "reconstruct/reconstructor.hpp"

namespace rptv {

/// One line, with the next step, for each camera whose first image is empty or saturated; if there is none, one when
/// the particle images of the first instant hardly meet in space, as with swapped or moved cameras. Nothing for a live
/// source or a light field. `stage` is what the configuration asks for; it reconstructs that instant. Throws Error for
/// images that cannot be read. Main thread.
std::vector<std::string> doubts_of_first_instant(const Config& config, Reconstructor& stage);

}  // namespace rptv
