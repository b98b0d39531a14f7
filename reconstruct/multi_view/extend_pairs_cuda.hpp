// SPDX-License-Identifier: MIT
// On the device: pairs become tuples of all views that see something where a pair says that the particle is.
#pragma once

#include "reconstruct/multi_view/seen_views_cuda.hpp"
#include "reconstruct/multi_view/view_pairs_cuda.hpp"
#include "reconstruct/multi_view/view_tuples_cuda.hpp"

namespace rptv {

/// Detections near a pair's place in a view; device memory. View v's h-th for pair p: hit[(8·v + h)·pairs + p], where
/// pairs is the capacity of the pairs, and hits[v·pairs + p] of them.
struct CudaHits {
  std::uint32_t *hit, *hits;
};

/// Which views and how far.
struct CudaExtension {
  std::uint32_t first, second;  ///< the views of the pairs; those after `second` are asked
  std::uint32_t min_views;
  double tolerance_px;
};

inline constexpr std::uint32_t kMostOfAPair = 512;  ///< tuples

/// Queues the sort of view `view`'s detections into cells, which extend_pairs_cuda() needs. False when the runtime
/// refuses.
bool sort_into_cells_cuda(const CudaViews& views, std::uint32_t view, std::uint32_t count, const CellOf& cell_of,
                          void* stream, unsigned threads_per_block = 128) noexcept;

/// Queues, for each pair, all tuples of one of the hits in each view that has some: those that Correspondence proposes,
/// in no order. Appends to `tuples`. False when the runtime refuses.
bool extend_pairs_cuda(const CudaViews& views, const CudaPairs& pairs, const CudaExtension& extension,
                       const CudaHits& scratch, const CudaTuples& tuples, CudaMatchCounts* counts, void* stream,
                       unsigned threads_per_block = 128) noexcept;

}  // namespace rptv
