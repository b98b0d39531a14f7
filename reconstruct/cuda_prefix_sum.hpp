// SPDX-License-Identifier: MIT
// Running sums by one block, for counting sorts.
#pragma once

#include <cstdint>

#include "reconstruct/cuda_device.hpp"

namespace rptv {

/// Each of `count` values becomes the sum of those up to it. Called by all threads of one block of a multiple of 32;
/// ends with a barrier.
__device__ inline void prefix_sum(std::uint32_t* values, std::uint32_t count) noexcept {
  constexpr std::uint32_t kWarp = 32, kAllLanes = 0xFFFFFFFFU;
  RPTV_SHARED(std::uint32_t, warp_sum, [32]);
  const std::uint32_t lane = threadIdx.x % kWarp, warp = threadIdx.x / kWarp, warps = blockDim.x / kWarp;
  std::uint32_t before_block = 0;
  for (std::uint32_t first = 0; first < count; first += blockDim.x) {
    const std::uint32_t i = first + threadIdx.x;
    std::uint32_t sum = i < count ? values[i] : 0;
    for (std::uint32_t step = 1; step < kWarp; step *= 2) {
      const std::uint32_t lower = __shfl_up_sync(kAllLanes, sum, step);
      sum += lane >= step ? lower : 0;
    }
    if (lane == kWarp - 1) warp_sum[warp] = sum;
    __syncthreads();
    std::uint32_t before = before_block;
    for (std::uint32_t w = 0; w < warps; ++w) {
      before += w < warp ? warp_sum[w] : 0;
      before_block += warp_sum[w];
    }
    if (i < count) values[i] = before + sum;
    __syncthreads();
  }
}

}  // namespace rptv
