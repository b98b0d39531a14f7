// SPDX-License-Identifier: MIT
// On the device: from lit maxima to detections with sub-pixel centres, as SpotFinder.
#pragma once

#include "reconstruct/detection/image_cuda.hpp"
#include "reconstruct/detection/spot_fit.hpp"

namespace rptv {

/// DetectorSettings as SpotFinder reads them. `options.method`: spots whose light overlaps are not untangled, which
/// SpotFinder does with `gaussian` where overlap_sweeps > 0.
struct CudaSpotSettings {
  SpotOptions options;
  float saturation_grey;  ///< from here a pixel tells nothing
  float split_sigmas;
  std::int32_t merge_reach_px;  ///< merge_reach()
  std::int32_t reach_px;        ///< how far maxima share out the pixels between them
  std::uint32_t min_area_px;
};

/// Scratch on the device: capacity of the maxima each.
struct CudaSpots {
  std::int32_t *middle_x, *middle_y;
  double *plateau_x, *plateau_y, *plateau_rows;
  std::uint32_t *merged, *kept, *place;
  float *x, *y, *variance, *grey, *area;  ///< x, y: from the middle
};

/// Device memory, capacity each. `count` may be beyond it: that many were found, and the last ones left out.
struct CudaDetections {
  double *x_px, *y_px, *sigma_px, *grey, *area_px;  ///< as Detections
  std::uint32_t* count;
  std::uint32_t capacity;
};

/// Device memory, as DetectorCounts; the caller zeroes it.
struct CudaSpotCounts {
  unsigned long long merged, too_small;
};

/// Queues all steps on `stream` (a cudaStream_t): the same detections, with the same bits and in the same order, as
/// SpotFinder::find() makes of the same maxima; but where more than eight neighbours a maximum are near on average, all
/// of them count here. `threads_per_block`: a multiple of 32. False when the runtime refuses.
bool find_spots_cuda(const CudaImage& image, const CudaDark& dark, const CudaMaxima& maxima,
                     const CudaSpotSettings& settings, const CudaSpots& scratch, const CudaDetections& out,
                     CudaSpotCounts* counts, void* stream, unsigned threads_per_block = 128) noexcept;

}  // namespace rptv
