// SPDX-License-Identifier: MIT
// Runs one CUDA thread of a PTX kernel, on the fiber that would run its C++: barriers and shuffles are the executor's.
#pragma once

#include "tests/cuda_host/ptx_program.hpp"

namespace rptv::cuda_host {

/// `parameters`: as the kernel's own description lays them out. Faults end the launch, as those of C++ kernels do.
void run_ptx_thread(const PtxKernel& kernel, const unsigned char* parameters);

/// The memory behind an address of `count` values of `value_bytes` each; what does not lie whole in one array, one
/// block of device memory or page-locked memory, or is not aligned, is a fault.
void* ptx_memory(const PtxKernel& kernel, const unsigned char* parameters, std::uint64_t address,
                 std::size_t value_bytes, std::size_t count, int line);

}  // namespace rptv::cuda_host
