// SPDX-License-Identifier: MIT
// A counting sort on the device: which items are in a bin.
#pragma once

#include "reconstruct/cuda_bins.hpp"
#include "reconstruct/cuda_launch.hpp"
#include "reconstruct/cuda_scan.hpp"

namespace rptv {

template <class BinOf>
__global__ void count_in_bins(BinOf bin_of, std::uint32_t items, CudaBins out) {
  for (std::uint32_t i = cuda_item(); i < items; i += cuda_stride()) {
    out.bin[i] = bin_of(i);
    if (out.bin[i] != kNoBin) atomicAdd(&out.start[out.bin[i] + 1], 1U);
  }
}

/// Begins where start[b + 1] is the first place of bin b, and ends where it is behind the last.
template <class BinOf>
__global__ void fill_bins(BinOf, std::uint32_t items, CudaBins out) {
  for (std::uint32_t i = cuda_item(); i < items; i += cuda_stride())
    if (out.bin[i] != kNoBin) out.entry[atomicAdd(&out.start[out.bin[i] + 1], 1U)] = i;
}

/// Queues on `stream` (a cudaStream_t) the sort of items 0 to `items` - 1 into bins 0 to `bins` - 1, by bin_of(i);
/// within a bin they have no order. `threads`: a multiple of 32. False when the runtime refuses.
template <class BinOf>
bool sort_into_bins(const BinOf& bin_of, std::uint32_t items, std::uint32_t bins, const CudaBins& out, void* stream,
                    unsigned threads) noexcept {
  return cudaMemsetAsync(out.start, 0, (bins + std::size_t{2}) * sizeof(std::uint32_t),
                         static_cast<cudaStream_t>(stream)) == cudaSuccess &&
         launch(count_in_bins<BinOf>, items, threads, stream, bin_of, items, out) &&
         exclusive_scan_cuda(out.start + 1, bins, nullptr, out.start + 1 + bins, stream, threads) &&
         launch(fill_bins<BinOf>, items, threads, stream, bin_of, items, out);
}

}  // namespace rptv
