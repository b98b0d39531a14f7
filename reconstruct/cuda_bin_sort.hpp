// SPDX-License-Identifier: MIT
// A counting sort on the device: which items are in a bin.
#pragma once

#include "reconstruct/cuda_bins.hpp"
#include "reconstruct/cuda_launch.hpp"
#include "reconstruct/cuda_prefix_sum.hpp"

namespace rptv {

template <class BinOf>
__global__ void count_in_bins(BinOf bin_of, std::uint32_t items, CudaBins out) {
  for (std::uint32_t i = cuda_item(); i < items; i += cuda_stride()) {
    out.bin[i] = bin_of(i);
    if (out.bin[i] != kNoBin) atomicAdd(&out.start[out.bin[i]], 1U);
  }
}

/// From counts to the end of each bin.
template <class BinOf>
__global__ void add_up_bins(CudaBins out, std::uint32_t bins) {
  prefix_sum(out.start, bins + 1);
}

template <class BinOf>
__global__ void fill_bins(BinOf, std::uint32_t items, CudaBins out) {
  for (std::uint32_t i = cuda_item(); i < items; i += cuda_stride())
    if (out.bin[i] != kNoBin) out.entry[atomicSub(&out.start[out.bin[i]], 1U) - 1] = i;
}

/// Queues on `stream` (a cudaStream_t) the sort of items 0 to `items` - 1 into bins 0 to `bins` - 1, by bin_of(i);
/// within a bin they have no order. `threads`: a multiple of 32. False when the runtime refuses.
template <class BinOf>
bool sort_into_bins(const BinOf& bin_of, std::uint32_t items, std::uint32_t bins, const CudaBins& out, void* stream,
                    unsigned threads) noexcept {
  return cudaMemsetAsync(out.start, 0, (bins + std::size_t{1}) * sizeof(std::uint32_t),
                         static_cast<cudaStream_t>(stream)) == cudaSuccess &&
         launch(count_in_bins<BinOf>, items, threads, stream, bin_of, items, out) &&
         launch(add_up_bins<BinOf>, threads, threads, stream, out, bins) &&
         launch(fill_bins<BinOf>, items, threads, stream, bin_of, items, out);
}

}  // namespace rptv
