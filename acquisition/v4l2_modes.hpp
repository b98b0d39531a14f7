// SPDX-License-Identifier: MIT
// What sizes and rates a V4L2 device has, in words, for those who asked for another one.
#pragma once

#include <cstdint>
#include <string>

#include "acquisition/v4l2_system.hpp"

namespace rptv {

/// "320 x 180, 640 x 480 px", or a range; empty where the driver does not tell. At most 16 are listed. Set-up only.
std::string v4l2_sizes(V4l2System& system, int descriptor, std::uint32_t fourcc);
/// "15, 30, 59.94 Hz" of one size, likewise.
std::string v4l2_rates(V4l2System& system, int descriptor, std::uint32_t fourcc, std::uint32_t width_px,
                       std::uint32_t height_px);

}  // namespace rptv
