// SPDX-License-Identifier: MIT
// What a user can do about a loss.
#pragma once

#include <string_view>

#include "core/losses.hpp"

namespace rptv {

/// The setting that gives more room, or where to look; empty where the name says all there is to say.
std::string_view advice_on(LossCause cause) noexcept;

}  // namespace rptv
