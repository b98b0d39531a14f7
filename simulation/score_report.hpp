// SPDX-License-Identifier: MIT
// Scores and profiles as text for people and as JSON for scripts.
#pragma once

#include <string>

#include "simulation/duct_profile.hpp"
#include "simulation/score.hpp"
#include "simulation/wall_profile.hpp"

namespace rptv {

/// Tables of a few lines, ending in a newline.
std::string to_text(const Score& score, const ScoreSettings& settings);
std::string to_text(const WallProfile& profile);
std::string to_text(const DuctProfile& profile);

/// One JSON object without a newline; keys are the names in the structs, arrays are [x, y, z].
std::string to_json(const Score& score);
std::string to_json(const WallProfile& profile);
std::string to_json(const DuctProfile& profile);

}  // namespace rptv
