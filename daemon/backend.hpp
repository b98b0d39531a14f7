// SPDX-License-Identifier: MIT
// Which processor reconstructs: what the configuration asks for, and what this machine has.
#pragma once

#include <string>

#include "daemon/config.hpp"
#include "reconstruct/cuda_probe.hpp"
#include "reconstruct/light_field/light_field_device.hpp"

namespace rptv {

struct Backend {
  MakeLightFieldDevice make_device;  ///< null: the CPU does all
  std::string text;                  ///< one line for people: where reconstruction runs, and why
};

/// Throws Error(unavailable) when reconstruction.backend = "cuda" cannot be had, with the reason.
Backend choose_backend(const Config& config, const CudaProbe& probe);

/// The same for this machine, which is asked once.
Backend choose_backend(const Config& config);

}  // namespace rptv
