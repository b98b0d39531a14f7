// SPDX-License-Identifier: MIT
// Kernel launches as plain function calls, and the index of a thread in them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "reconstruct/cuda_device.hpp"

namespace rptv {

/// Queues `kernel` on `stream` (a cudaStream_t) with `blocks` blocks, each with `shared_bytes` of dynamic shared memory
/// (at most 48 KiB). False when the runtime refuses; its error stays with take_cuda_error(). No blocks are no launch.
template <class... Parameters, class... Arguments>
bool launch_blocks(void (*kernel)(Parameters...), std::size_t blocks, unsigned threads_per_block,
                   std::size_t shared_bytes, void* stream, const Arguments&... arguments) noexcept {
  if (blocks == 0) return true;
  cudaLaunchConfig_t config{};
  config.gridDim = dim3(static_cast<unsigned>(blocks));
  config.blockDim = dim3(threads_per_block);
  config.dynamicSmemBytes = shared_bytes;
  config.stream = static_cast<cudaStream_t>(stream);
  return cudaLaunchKernelEx(&config, kernel, Parameters(arguments)...) == cudaSuccess;
}

/// The same with as many blocks as give `items` a thread each, 2048 at most: a kernel goes on from item i to
/// i + cuda_stride(). No items are no launch.
template <class... Parameters, class... Arguments>
bool launch(void (*kernel)(Parameters...), std::size_t items, unsigned threads_per_block, void* stream,
            const Arguments&... arguments) noexcept {
  const std::size_t blocks = (items + threads_per_block - 1) / threads_per_block;
  return launch_blocks(kernel, blocks < 2048 ? blocks : 2048, threads_per_block, 0, stream, arguments...);
}

/// Of a one-dimensional launch: the first item of this thread.
__device__ inline std::uint32_t cuda_item() noexcept { return blockIdx.x * blockDim.x + threadIdx.x; }
/// How far the next item of this thread is.
__device__ inline std::uint32_t cuda_stride() noexcept { return gridDim.x * blockDim.x; }

/// Threads that run together, and the mask that names all of them.
constexpr std::uint32_t kWarp = 32, kAllLanes = 0xFFFFFFFFU;

/// This thread's number in its warp, where blocks are one-dimensional and of whole warps.
__device__ inline std::uint32_t cuda_lane() noexcept { return threadIdx.x % kWarp; }
/// Those of `lanes` (a ballot) that come before this thread's.
__device__ inline std::uint32_t lanes_before(std::uint32_t lanes) noexcept {
  return static_cast<std::uint32_t>(__popc(lanes & ((1U << cuda_lane()) - 1)));
}

}  // namespace rptv
