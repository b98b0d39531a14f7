// SPDX-License-Identifier: MIT
// What `rapidptv reconstruct` does for the cameras of a rig.
#pragma once

#include <string>

#include "core/error.hpp"
#include "daemon/config.hpp"

namespace rptv {

/// Reconstructs every instant of replay.path by [multi_view] into a table of points. Throws Error.
ExitCode reconstruct_views(const Config& config, const std::string& output);

}  // namespace rptv
