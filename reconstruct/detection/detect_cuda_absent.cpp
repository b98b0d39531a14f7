// SPDX-License-Identifier: MIT
// The device of a build without CUDA.
#include "core/error.hpp"
#include "reconstruct/cuda_probe.hpp"
#include "reconstruct/detection/detect_cuda.hpp"

namespace rptv {

std::unique_ptr<DetectDevice> make_detect_cuda(const DetectDevicePlan&) {
  throw Error(ExitCode::unavailable, "CUDA: " + probe_cuda().text);
}

}  // namespace rptv
