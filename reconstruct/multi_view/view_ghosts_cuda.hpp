// SPDX-License-Identifier: MIT
// On the device: which of the tuples are particles, by rank, each detection in one at most.
#pragma once

#include "reconstruct/multi_view/view_tuples_cuda.hpp"

namespace rptv {

enum class CudaRank : std::uint32_t {
  by_s,             ///< the seed's: rising s, as GhostOptions::by_rank
  by_views_then_s,  ///< those of more views first: a part of a tuple always has a smaller s than the whole
};

/// Device memory. Of view v's detection d: [v·max_detections + d].
struct CudaGhosts {
  const double* s;        ///< of each tuple
  std::uint32_t* chosen;  ///< of each tuple: 1 where it is chosen, and stays so in later calls; the caller zeroes it
  std::uint32_t* used;   ///< by detection: 1 where a tuple that was chosen has it; the caller zeroes it for a new frame
  std::uint32_t* owner;  ///< by detection: scratch
  std::uint32_t max_detections;
};

/// Queues the choice on `stream` (a cudaStream_t): what going through the tuples in order of rank and taking each whose
/// detections are all free gives. Of equal ranks that with the lower detections (unseen: none) goes first, so the order
/// of the tuples is of no account. A tuple whose s is not a number is never taken. One block, which goes in rounds:
/// each takes every tuple that is the best at all its detections, and drops those that lose one by it; the best tuple
/// left is always taken, so it ends. False when the runtime refuses.
bool choose_by_rank_cuda(const CudaTuples& tuples, const CudaGhosts& ghosts, CudaRank rank, void* stream,
                         unsigned threads_per_block = 512) noexcept;

}  // namespace rptv
