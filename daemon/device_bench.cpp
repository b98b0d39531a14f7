// SPDX-License-Identifier: MIT
// One round without events and one with.
#include "daemon/device_bench.hpp"

#include "core/clock.hpp"
#include "core/error.hpp"

namespace rptv {

void DeviceBench::round(const std::function<void()>& reconstruct) {
  const std::int64_t start_ns = host_now_ns();
  reconstruct();
  const std::int64_t end_ns = host_now_ns();
  StageCosts costs{};
  timer_.start();
  reconstruct();
  if (!timer_.stop(costs))
    throw Error(ExitCode::unavailable, "CUDA: the stages could not be timed; see what nvidia-smi says");
  if (of(costs, CudaStage::upload).bytes == 0)
    throw Error(ExitCode::unavailable, "CUDA: the CPU did a frame, the device has failed; see what nvidia-smi says");
  result_->latency_ns.record(end_ns - start_ns);
  for (std::size_t s = 0; s < kCudaStages; ++s) {
    DeviceStageTimes& stage = result_->stages[s];
    stage.device_ns.record(static_cast<std::int64_t>(costs[s].device_ms * 1e6));
    stage.sum.device_ms += costs[s].device_ms;
    stage.sum.bytes += costs[s].bytes, stage.sum.increments += costs[s].increments;
  }
}

}  // namespace rptv
