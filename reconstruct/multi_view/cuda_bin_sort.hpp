// SPDX-License-Identifier: MIT
// A counting sort of one view's detections on the device: which are in a bin.
#pragma once

#include "reconstruct/cuda_launch.hpp"
#include "reconstruct/cuda_prefix_sum.hpp"
#include "reconstruct/multi_view/seen_views_cuda.hpp"

namespace rptv {

template <class BinOf>
__global__ void count_in_bins(CudaSeen seen, BinOf bin_of, CudaBins out) {
  for (std::uint32_t i = cuda_item(); i < seen.count; i += cuda_stride()) {
    if (seen.u[i] != seen.u[i]) continue;
    out.bin[i] = bin_of(seen.u[i], seen.v[i]);
    atomicAdd(&out.start[out.bin[i]], 1U);
  }
}

/// From counts to the end of each bin.
template <class BinOf>
__global__ void add_up_bins(CudaBins out, std::uint32_t bins) {
  prefix_sum(out.start, bins + 1);
}

template <class BinOf>
__global__ void fill_bins(CudaSeen seen, BinOf, CudaBins out) {
  for (std::uint32_t i = cuda_item(); i < seen.count; i += cuda_stride())
    if (seen.u[i] == seen.u[i]) out.entry[atomicSub(&out.start[out.bin[i]], 1U) - 1] = i;
}

/// Queues the sort of all usable detections into `bins` bins by bin_of(u, v); within a bin they have no order.
template <class BinOf>
bool sort_into_bins(const CudaSeen& seen, const BinOf& bin_of, std::uint32_t bins, const CudaBins& out, void* stream,
                    unsigned threads) noexcept {
  return cudaMemsetAsync(out.start, 0, (bins + std::size_t{1}) * sizeof(std::uint32_t),
                         static_cast<cudaStream_t>(stream)) == cudaSuccess &&
         launch(count_in_bins<BinOf>, seen.count, threads, stream, seen, bin_of, out) &&
         launch(add_up_bins<BinOf>, threads, threads, stream, out, bins) &&
         launch(fill_bins<BinOf>, seen.count, threads, stream, seen, bin_of, out);
}

}  // namespace rptv
