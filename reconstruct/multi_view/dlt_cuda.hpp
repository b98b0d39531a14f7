// SPDX-License-Identifier: MIT
// The DLT of eq. (4) on the device, a tuple a thread.
#pragma once

#include "reconstruct/multi_view/view_tuples_cuda.hpp"

namespace rptv {

/// On the device, two rows (a, b, c, d) of A a detection, as DltRowPair lies in memory: those of detection d of view v
/// begin at value[8·(v·max_detections + d)].
struct CudaDltRows {
  const double* value;
  std::uint32_t max_detections;
};

/// Queues the solution of all tuples on `stream` (a cudaStream_t). Same bits as Dlt: neither side contracts, and views
/// that do not see the particle add nothing there. False when the runtime refuses.
bool solve_dlt_cuda(const CudaDltRows& rows, const CudaTuples& tuples, const CudaPoints& out, void* stream,
                    unsigned threads_per_block = 128) noexcept;

}  // namespace rptv
