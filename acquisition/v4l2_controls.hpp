// SPDX-License-Identifier: MIT
// Controls of a V4L2 device (exposure, gain, …) by the names that v4l2-ctl shows.
#pragma once

#include <string>
#include <vector>

#include "acquisition/v4l2_system.hpp"

namespace rptv {

/// Sets controls of the open device `path`, in their order. Each of `wishes` is "name=value"; names are in lower case
/// with underscores; the value is a number (0x… for hexadecimal), true or false, or of a menu the entry's number or
/// text. Returns what the driver did otherwise, one line each. Throws Error(configuration) for a name, value or range
/// that the device does not have (it says what it has), Error(unavailable) when the driver refuses. Set-up only.
std::vector<std::string> set_v4l2_controls(V4l2System& system, int descriptor, const std::string& path,
                                           const std::vector<std::string>& wishes);

}  // namespace rptv
