// SPDX-License-Identifier: MIT
// Work of a stream that is recorded once and then launched whole, with an owner, for code that knows no CUDA header.
#pragma once

#include "reconstruct/cuda_memory.hpp"

namespace rptv {

/// Kernels and copies with their arguments: the same memory each time, with what it holds then. One thread at a time.
class CudaGraph {
 public:
  CudaGraph() = default;
  ~CudaGraph();
  CudaGraph(const CudaGraph&) = delete;
  CudaGraph& operator=(const CudaGraph&) = delete;

  /// Records what queue() puts on `stream` (true: all of it), which does not run now; replaces what was recorded. Host
  /// memory of copies must be pinned, and nothing may wait. False when the runtime refuses: there is no graph then.
  template <class Queue>
  bool record(CudaStream& stream, const Queue& queue) noexcept {
    if (!begin(stream)) return false;
    const bool queued = queue();
    return end(stream) && queued;
  }
  /// Queues all of it on `stream`; false without a graph.
  bool launch(CudaStream& stream) noexcept;

 private:
  bool begin(CudaStream& stream) noexcept;
  bool end(CudaStream& stream) noexcept;

  void* executable_ = nullptr;  // a cudaGraphExec_t
};

}  // namespace rptv
