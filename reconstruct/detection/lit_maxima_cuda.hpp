// SPDX-License-Identifier: MIT
// find_lit_maxima() on the device: a warp a row counts, one block adds up, and a warp a row writes.
#pragma once

#include "reconstruct/detection/image_cuda.hpp"

namespace rptv {

/// Queues the search on `stream` (a cudaStream_t): the same maxima in the same order as find_lit_maxima(), and as many
/// left out where they are too many. `threads_per_block`: a multiple of 32. False when the runtime refuses.
bool find_lit_maxima_cuda(const CudaImage& image, const CudaDark& dark, const CudaMaxima& out, void* stream,
                          unsigned threads_per_block = 128) noexcept;

}  // namespace rptv
