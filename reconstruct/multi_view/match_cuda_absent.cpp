// SPDX-License-Identifier: MIT
// Matching on the device in a build without CUDA.
#include "core/error.hpp"
#include "reconstruct/cuda_probe.hpp"
#include "reconstruct/multi_view/match_cuda.hpp"

namespace rptv {

std::unique_ptr<MatchDevice> make_match_cuda(const MatchDevicePlan&) {
  throw Error(ExitCode::unavailable, "CUDA: " + probe_cuda().text);
}

}  // namespace rptv
