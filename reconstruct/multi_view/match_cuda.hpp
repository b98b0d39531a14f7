// SPDX-License-Identifier: MIT
// A MatchDevice on CUDA.
#pragma once

#include "reconstruct/multi_view/match_device.hpp"

namespace rptv {

/// On the device that is current. Throws Error(unavailable) where a camera sees another, which only the CPU's search
/// can do, when the device has not enough memory, and in a build without CUDA.
std::unique_ptr<MatchDevice> make_match_cuda(const MatchDevicePlan& plan);

}  // namespace rptv
