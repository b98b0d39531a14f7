// SPDX-License-Identifier: MIT
// Scan by one block, four values a thread at a time; blocks that wait for each other would need them all to run at
// once.
#include "reconstruct/cuda_scan.hpp"

#include "reconstruct/cuda_launch.hpp"

namespace rptv {

namespace {

constexpr std::uint32_t kMostWarps = 32, kValues = 4;

__device__ std::uint32_t sum_up_to_lane(std::uint32_t value) {
  for (unsigned step = 1; step < kWarp; step *= 2) {
    const std::uint32_t before = __shfl_up_sync(kAllLanes, value, step);
    value += cuda_lane() >= step ? before : 0;
  }
  return value;
}

__global__ void scan(std::uint32_t* values, std::uint32_t most, const std::uint32_t* live, std::uint32_t* total) {
  RPTV_SHARED(std::uint32_t, warp_sums, [kMostWarps]);
  const std::uint32_t size = live == nullptr ? most : min(*live, most);
  const std::uint32_t warp = threadIdx.x / kWarp, warps = blockDim.x / kWarp;
  std::uint32_t before_all = 0;
  for (std::uint32_t first = 0; first < size; first += kValues * blockDim.x) {
    const std::uint32_t mine = first + kValues * threadIdx.x;
    std::uint32_t value[kValues], sum = 0;
    for (std::uint32_t k = 0; k < kValues; ++k) {
      value[k] = mine + k < size ? values[mine + k] : 0;
      sum += value[k];
    }
    const std::uint32_t up_to = sum_up_to_lane(sum);
    if (cuda_lane() == kWarp - 1) warp_sums[warp] = up_to;
    __syncthreads();
    std::uint32_t before = before_all + up_to - sum;
    for (std::uint32_t w = 0; w < warps; ++w) {
      before += w < warp ? warp_sums[w] : 0;
      before_all += warp_sums[w];
    }
    __syncthreads();  // before the next round writes warp_sums
    for (std::uint32_t k = 0; k < kValues; ++k) {
      if (mine + k < size) values[mine + k] = before;
      before += value[k];
    }
  }
  if (threadIdx.x == 0) *total = before_all;
}

}  // namespace

bool exclusive_scan_cuda(std::uint32_t* values, std::size_t size, const std::uint32_t* live, std::uint32_t* total,
                         void* stream, unsigned threads_per_block) noexcept {
  return launch_blocks(scan, 1, threads_per_block, 0, stream, values, static_cast<std::uint32_t>(size), live, total);
}

}  // namespace rptv
