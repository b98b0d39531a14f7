// SPDX-License-Identifier: MIT
// Capture of a stream, and launches of what it captured.
#include "reconstruct/cuda_graph.hpp"

#include "reconstruct/cuda_device.hpp"

namespace rptv {

CudaGraph::~CudaGraph() {
  if (executable_ != nullptr) cudaGraphExecDestroy(static_cast<cudaGraphExec_t>(executable_));
}

bool CudaGraph::begin(CudaStream& stream) noexcept {
  return cudaStreamBeginCapture(static_cast<cudaStream_t>(stream.handle()), cudaStreamCaptureModeThreadLocal) ==
         cudaSuccess;
}

bool CudaGraph::end(CudaStream& stream) noexcept {
  if (executable_ != nullptr) cudaGraphExecDestroy(static_cast<cudaGraphExec_t>(executable_));
  executable_ = nullptr;
  cudaGraph_t graph{};
  if (cudaStreamEndCapture(static_cast<cudaStream_t>(stream.handle()), &graph) != cudaSuccess) return false;
  cudaGraphExec_t executable{};
  const bool done = cudaGraphInstantiateWithFlags(&executable, graph, 0) == cudaSuccess;
  cudaGraphDestroy(graph);
  if (done) executable_ = executable;
  return done;
}

bool CudaGraph::launch(CudaStream& stream) noexcept {
  return executable_ != nullptr && cudaGraphLaunch(static_cast<cudaGraphExec_t>(executable_),
                                                   static_cast<cudaStream_t>(stream.handle())) == cudaSuccess;
}

}  // namespace rptv
