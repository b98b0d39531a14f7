// SPDX-License-Identifier: MIT
// What set-up does when the CUDA runtime refuses, for CUDA sources.
#pragma once

#include <string>

#include "core/error.hpp"
#include "reconstruct/cuda_device.hpp"

namespace rptv {

/// Throws Error(unavailable) with `what` and the runtime's words unless `result` is success; the runtime forgets it.
inline void require_cuda(cudaError_t result, const std::string& what) {
  if (result == cudaSuccess) return;
  cudaGetLastError();
  throw Error(ExitCode::unavailable, std::string("CUDA: ") + what + ": " + cudaGetErrorName(result) + " (" +
                                         cudaGetErrorString(result) + "); take reconstruction.backend = \"cpu\"");
}

}  // namespace rptv
