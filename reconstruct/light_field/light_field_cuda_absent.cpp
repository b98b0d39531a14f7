// SPDX-License-Identifier: MIT
// The device of a build without CUDA.
#include "core/error.hpp"
#include "reconstruct/cuda_probe.hpp"
#include "reconstruct/light_field/light_field_cuda.hpp"

namespace rptv {

std::unique_ptr<LightFieldDevice> make_light_field_cuda(const LightFieldDevicePlan&) {
  throw Error(ExitCode::unavailable, "CUDA: " + probe_cuda().text);
}

}  // namespace rptv
