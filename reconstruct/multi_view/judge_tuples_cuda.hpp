// SPDX-License-Identifier: MIT
// On the device: which tuples meet, which are tried again with a view less, and what good ones settle.
#pragma once

#include "reconstruct/multi_view/dlt_cuda.hpp"
#include "reconstruct/multi_view/seen_views_cuda.hpp"
#include "reconstruct/multi_view/view_tuples_cuda.hpp"

namespace rptv {

struct CudaJudging {
  Point3 half_mm;   ///< of the volume: points beyond it are no matches
  double scale_mm;  ///< of the DLT's coordinates
  double tolerance_px;
  std::uint32_t min_views;
};

/// Tuples that meet, as ViewMatch; device memory, capacity of `tuples` each.
struct CudaMatches {
  CudaTuples tuples;
  double *x_mm, *y_mm, *z_mm;  ///< relative to the volume's centre
  double *square_px2, *s;
};

/// Queues judgement on `stream` (a cudaStream_t): tuples whose reprojection errors are all within the tolerance are
/// appended to `matches`, with the bits of TupleSolver; of the others, those with views to spare are appended to
/// `doubtful` without their worst view, and where one less is the least there may be, without each of theirs. In no
/// order. False when the runtime refuses, as below.
bool judge_tuples_cuda(const CudaViews& views, const CudaTuples& tuples, const CudaPoints& points,
                       const CudaJudging& judging, const CudaMatches& matches, const CudaTuples& doubtful, void* stream,
                       unsigned threads_per_block = 128) noexcept;

/// Queues what Correspondence::settle() does, with all matches so far.
bool settle_cuda(const CudaViews& views, const CudaMatches& matches, double tolerance_px, void* stream,
                 unsigned threads_per_block = 128) noexcept;

/// Queues the remains of matches that are not `chosen`: appends to `tuples` what others leave them (`used`, by
/// detection, as CudaViews has them), where that is less than they had and min_views at least.
bool list_remains_cuda(const CudaMatches& matches, const std::uint32_t* chosen, const std::uint32_t* used,
                       std::uint32_t max_detections, std::uint32_t min_views, const CudaTuples& tuples, void* stream,
                       unsigned threads_per_block = 128) noexcept;

/// Queues the end of a list: what is in `count` beyond `capacity` is added to `refused`, and `count` is zeroed.
bool end_list_cuda(std::uint32_t* count, std::uint32_t capacity, unsigned long long* refused, void* stream) noexcept;

/// A chosen match as it goes back to the host.
struct CudaChosen {
  std::uint32_t detection[kCudaMaxViews];
  double at_mm[3], square_px2, s;
};

/// Queues the copy of all matches that are chosen to `out`, in no order; `count` may be beyond `capacity`.
bool pack_chosen_cuda(const CudaMatches& matches, const std::uint32_t* chosen, CudaChosen* out, std::uint32_t* count,
                      std::uint32_t capacity, void* stream, unsigned threads_per_block = 128) noexcept;

}  // namespace rptv
