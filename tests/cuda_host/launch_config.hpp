// SPDX-License-Identifier: MIT
// Launches of tests in one line.
#pragma once

#include <cuda_runtime.h>

namespace rptv::cuda_host {

inline cudaLaunchConfig_t launch_of(unsigned blocks, unsigned threads, cudaStream_t stream = nullptr,
                                    std::size_t dynamic_bytes = 0) {
  cudaLaunchConfig_t launch{};
  launch.gridDim = blocks;
  launch.blockDim = threads;
  launch.dynamicSmemBytes = dynamic_bytes;
  launch.stream = stream;
  return launch;
}

}  // namespace rptv::cuda_host
