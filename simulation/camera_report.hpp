// SPDX-License-Identifier: MIT
// What a simulated camera amounts to, for people.
#pragma once

#include <string>

#include "simulation/scenario.hpp"

namespace rptv {

/// Lines of text: the lens by its first-order figures (and its prescription's), the array, the sub-images, the field.
/// Throws Error as make_main_lens() does.
std::string describe_camera(const ScenarioSettings& scenario);

}  // namespace rptv
