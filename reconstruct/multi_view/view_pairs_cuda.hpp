// SPDX-License-Identifier: MIT
// On the device: pairs of detections of two views whose rays pass each other within a tolerance, in the volume.
#pragma once

#include <cstdint>

#include "reconstruct/multi_view/pencil_kernel.hpp"
#include "reconstruct/multi_view/seen_views_cuda.hpp"
#include "reconstruct/multi_view/view_tuples_cuda.hpp"

namespace rptv {

/// Rays of the first view are followed through the second's image.
struct CudaPairSearch {
  CudaSeen first, second;
  Matrix3 first_axes, second_axes;
  Projection second_pinhole;
  PencilOfLines lines;  ///< of the first view in the second; usable
  Point3 half_mm;       ///< of the volume
  double error_px;      ///< largest distance between line and detection
  double wander_px;     ///< ViewRays::wander_px() of the second view
};

/// Device memory. `count` may be beyond `capacity`: that many there are; which have no room is not said.
struct CudaPairs {
  std::uint32_t *first, *second;  ///< detections; capacity each
  double* depth_mm;               ///< on the first one's ray
  std::uint32_t* count;
  std::uint32_t capacity;
  CudaMatchCounts* totals = nullptr;  ///< null, or where rays and pairs are added up; settled ones count as pairs
};

/// Queues the search on `stream` (a cudaStream_t): what EpipolarPencil::visit_near() visits from every usable,
/// unsettled detection of the first view, with the same bits, in no order; with `wander_px`, of those the rays of which
/// pass within error_px, at the depth where they do.
/// `scratch` has room for max(second.count, 1) bins. `threads_per_block`: a multiple of 32. False when the runtime
/// refuses.
bool find_pairs_cuda(const CudaPairSearch& search, const CudaBins& scratch, const CudaPairs& out, void* stream,
                     unsigned threads_per_block = 128) noexcept;

}  // namespace rptv
