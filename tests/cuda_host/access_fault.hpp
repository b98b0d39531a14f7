// SPDX-License-Identifier: MIT
// Says in one line what a forbidden access to device memory was before it ends the process.
#pragma once

namespace rptv::cuda_host {

class DeviceMemory;

/// Installs a handler of SIGSEGV, except under AddressSanitizer, which has its own and knows more. A fault that has
/// nothing to do with device memory, or stacks of CUDA threads, is left to whoever handled it before.
void explain_access_faults(const DeviceMemory& memory);

}  // namespace rptv::cuda_host
