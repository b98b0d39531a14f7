// SPDX-License-Identifier: MIT
// Finds the PTX of a kernel that is launched: by the name of its function in this executable.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/cuda_host/launch.hpp"
#include "tests/cuda_host/ptx_program.hpp"

namespace rptv::cuda_host {

/// True where RPTV_CUDA_PTX names files (with : between), which then hold every kernel that is launched.
bool runs_ptx();

/// What a launch runs instead of the kernel's C++. Throws PtxError where there is no PTX, or where it does not fit.
std::function<void()> ptx_body(const void* kernel, const ArgumentView* arguments, std::size_t count);

/// A name as both compilers would have given it: nvcc makes anonymous namespaces unique per file.
std::string common_name(const std::string& mangled);

/// The mangled name of a function of this executable, from its symbol table; empty if unknown.
std::string symbol_at(const void* function);

}  // namespace rptv::cuda_host
