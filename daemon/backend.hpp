// SPDX-License-Identifier: MIT
// Which processor reconstructs: what the configuration asks for, what this machine has, and what a trial shows.
#pragma once

#include <string>

#include "daemon/config.hpp"
#include "reconstruct/cuda_probe.hpp"
#include "reconstruct/detection/detect_trial.hpp"
#include "reconstruct/light_field/device_trial.hpp"

namespace rptv {

struct Backend {
  bool device = false;  ///< false: the CPU does all
  std::string text;     ///< one line for people: where reconstruction runs, and why
};

/// For people: a GPU failed on the way, and so many frame sets were done without it since.
std::string device_failure(std::uint64_t sets_without_device);

/// Before anything is set up. Throws Error(unavailable) when reconstruction.backend = "cuda" cannot be had, with the
/// reason.
Backend choose_backend(const Config& config, const CudaProbe& probe);

/// The same for this machine, which is asked once.
Backend choose_backend(const Config& config);

/// After the trial of a device at `work`. "auto" takes it where it is right and faster than the CPU. Throws
/// Error(unavailable) for a device that is not right and must be used.
Backend judge(const Config& config, const std::string& device, const DeviceTrial& trial, const std::string& work);

/// The device of this machine, if `backend` has one and it stands the trial; `backend` becomes what the trial says.
/// Throws Error(unavailable).
std::unique_ptr<LightFieldDevice> make_tried_device(const Config& config, const LightFieldDevicePlan& plan,
                                                    Backend& backend);
std::unique_ptr<DetectDevice> make_tried_device(const Config& config, const DetectDevicePlan& plan, Backend& backend);

}  // namespace rptv
