// SPDX-License-Identifier: MIT
// The stage timer and the limits of a build without CUDA.
#include "core/error.hpp"
#include "reconstruct/cuda_device_limits.hpp"
#include "reconstruct/cuda_probe.hpp"
#include "reconstruct/cuda_stage_timer.hpp"

namespace rptv {

StageTimer::StageTimer() { throw Error(ExitCode::unavailable, "CUDA: " + probe_cuda().text); }
StageTimer::~StageTimer() = default;
void StageTimer::start() noexcept {}
bool StageTimer::stop(StageCosts&) noexcept { return false; }

CudaDeviceLimits ask_cuda_device_limits() { throw Error(ExitCode::unavailable, "CUDA: " + probe_cuda().text); }

}  // namespace rptv
