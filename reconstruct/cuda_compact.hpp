// SPDX-License-Identifier: MIT
// Of many items those that matter, in their order: warps count runs of items, running sums say where, warps write.
#pragma once

#include "reconstruct/cuda_launch.hpp"
#include "reconstruct/cuda_scan.hpp"

namespace rptv {

template <class Keep>
__global__ void count_kept(Keep keep, std::uint32_t items, std::uint32_t* kept_of_run) {
  const std::uint32_t runs = (items + kCompactRun - 1) / kCompactRun;
  for (std::uint32_t run = cuda_item() / kWarp; run < runs; run += cuda_stride() / kWarp) {
    std::uint32_t kept = 0;
    for (std::uint32_t k = 0; k < kCompactRun; k += kWarp) {
      const std::uint32_t item = run * kCompactRun + k + cuda_lane();
      kept += static_cast<std::uint32_t>(__popc(__ballot_sync(kAllLanes, item < items && keep(item))));
    }
    if (cuda_lane() == 0) kept_of_run[run] = kept;
  }
}

template <class Keep, class Write>
__global__ void write_kept(Keep keep, Write write, std::uint32_t items, const std::uint32_t* first_of_run,
                           const std::uint32_t* total, std::uint32_t capacity) {
  const std::uint32_t runs = (items + kCompactRun - 1) / kCompactRun;
  for (std::uint32_t run = cuda_item() / kWarp; run < runs; run += cuda_stride() / kWarp) {
    std::uint32_t next = first_of_run[run];
    if (next == (run + 1 < runs ? first_of_run[run + 1] : *total)) continue;  // almost everywhere
    for (std::uint32_t k = 0; k < kCompactRun; k += kWarp) {
      const std::uint32_t item = run * kCompactRun + k + cuda_lane();
      const bool kept = item < items && keep(item);
      const std::uint32_t lanes = __ballot_sync(kAllLanes, kept), at = next + lanes_before(lanes);
      if (kept && at < capacity) write(at, item);
      next += static_cast<std::uint32_t>(__popc(lanes));
    }
  }
}

/// Queues write(k, item) for the k-th of the items 0 … items - 1 with keep(item), k < capacity; *total becomes how many
/// there are. `run_memory`: compact_runs(items) on the device. `keep` is asked twice. False when the runtime refuses.
template <class Keep, class Write>
bool compact_cuda(const Keep& keep, const Write& write, std::size_t items, std::uint32_t* run_memory,
                  std::uint32_t* total, std::uint32_t capacity, void* stream, unsigned threads_per_block) noexcept {
  const std::size_t runs = compact_runs(items);
  return launch(count_kept<Keep>, runs * kWarp, threads_per_block, stream, keep, items, run_memory) &&
         exclusive_scan_cuda(run_memory, runs, nullptr, total, stream, threads_per_block) &&
         launch(write_kept<Keep, Write>, runs * kWarp, threads_per_block, stream, keep, write, items, run_memory, total,
                capacity);
}

}  // namespace rptv
