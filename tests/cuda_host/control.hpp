// SPDX-License-Identifier: MIT
// What tests ask of the executor beyond CUDA: schedules, the text of a fault, and machines without a usable device.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace rptv::cuda_host {

/// 0: blocks and threads run in ascending order; any other value: an order of its own. At start: RPTV_CUDA_SEED, or 0.
void set_schedule_seed(std::uint64_t seed);

/// What went wrong in a kernel or a call, in one line; empty if nothing did since forget_faults(). A fault in a
/// kernel makes every later call return cudaErrorLaunchFailure, as on the device.
std::string last_fault();
void forget_faults();

/// Bytes of live cudaMalloc() blocks.
std::size_t device_bytes_in_use();

/// What the probe of devices finds: the version as cudaDriverGetVersion() gives it (0: no driver) and the number of
/// devices.
void set_machine(int driver_version, int devices);

}  // namespace rptv::cuda_host
