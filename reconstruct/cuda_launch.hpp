// SPDX-License-Identifier: MIT
// Kernel launches as plain function calls, and the index of a thread in them.
#pragma once

#include <cstdint>

#include "reconstruct/cuda_device.hpp"

namespace rptv {

/// Queues `kernel` on `stream` (a cudaStream_t) with as many blocks as give `items` a thread each, 2048 at most: a
/// kernel goes on from item i to i + cuda_stride(). False when the runtime refuses; its error stays with
/// take_cuda_error(). No items are no launch.
template <class... Parameters, class... Arguments>
bool launch(void (*kernel)(Parameters...), std::size_t items, unsigned threads_per_block, void* stream,
            const Arguments&... arguments) noexcept {
  if (items == 0) return true;
  const std::size_t blocks = (items + threads_per_block - 1) / threads_per_block;
  cudaLaunchConfig_t config{};
  config.gridDim = dim3(static_cast<unsigned>(blocks < 2048 ? blocks : 2048));
  config.blockDim = dim3(threads_per_block);
  config.stream = static_cast<cudaStream_t>(stream);
  return cudaLaunchKernelEx(&config, kernel, Parameters(arguments)...) == cudaSuccess;
}

/// Of a one-dimensional launch: the first item of this thread.
__device__ inline std::uint32_t cuda_item() noexcept { return blockIdx.x * blockDim.x + threadIdx.x; }
/// How far the next item of this thread is.
__device__ inline std::uint32_t cuda_stride() noexcept { return gridDim.x * blockDim.x; }

}  // namespace rptv
