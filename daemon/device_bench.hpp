// SPDX-License-Identifier: MIT
// Rounds of one reconstruction on a device: how long each takes, and each stage on the device.
#pragma once

#include <functional>
#include <string>

#include "core/latency.hpp"
#include "reconstruct/cuda_device_limits.hpp"
#include "reconstruct/cuda_stage_timer.hpp"

namespace rptv {

/// Of all rounds.
struct DeviceStageTimes {
  LatencyHistogram device_ns;
  StageCost sum;
};

struct DeviceBenchResult {
  LatencyHistogram latency_ns;  ///< image to particles, copies and the CPU's part included
  std::array<DeviceStageTimes, kCudaStages> stages{};
};

/// Measures work whose streams were made while `timer`, which must outlive it, watched. One thread.
class DeviceBench {
 public:
  explicit DeviceBench(StageTimer& timer) : timer_(timer), result_(std::make_unique<DeviceBenchResult>()) {}

  /// Does the work twice: untouched, for its latency by the host's clock, and with events between the stages, which may
  /// take longer. Throws Error(unavailable) when the device did not do its part.
  void round(const std::function<void()>& reconstruct);
  const DeviceBenchResult& result() const noexcept { return *result_; }

 private:
  StageTimer& timer_;
  std::unique_ptr<DeviceBenchResult> result_;
};

/// A table for people; one JSON object, times in ns, bytes and increments of a mean round, rates in 1/s, null: not
/// known. Rates are bytes or increments of all rounds by the device's time of all.
std::string to_text(const DeviceBenchResult& result, const CudaDeviceLimits& limits);
std::string to_json(const DeviceBenchResult& result, const CudaDeviceLimits& limits);

}  // namespace rptv
