// SPDX-License-Identifier: MIT
// Captures, and launches of what they captured.
#include "tests/cuda_host/graph_api.hpp"

#include <memory>

#include "tests/cuda_host/captured_graph.hpp"
#include "tests/cuda_host/runtime.hpp"

using namespace rptv::cuda_host;

cudaError_t cudaStreamBeginCapture(cudaStream_t stream, cudaStreamCaptureMode) {
  return call([&](Runtime& device) {
    if (stream == nullptr || stream->capture != nullptr) return cudaErrorStreamCaptureUnsupported;
    stream->capture = new CUgraph_st;
    stream->capture_queue = stream->capture->queues.add_queue();
    stream->began_capture = true;
    stream->capture->joined.push_back(stream);
    device.captures.insert(stream->capture);
    return cudaSuccess;
  });
}

cudaError_t cudaStreamEndCapture(cudaStream_t stream, cudaGraph_t* graph) {
  return call([&](Runtime& device) {
    *graph = nullptr;
    if (stream == nullptr || !stream->began_capture) return cudaErrorStreamCaptureUnmatched;
    std::unique_ptr<CUgraph_st> captured(stream->capture);
    device.captures.erase(captured.get());
    for (CUstream_st* joined : captured->joined) joined->capture = nullptr;
    stream->began_capture = false;
    if (captured->invalid)
      return device.blame(cudaErrorStreamCaptureInvalidated, "capture: the host waited for a captured stream");
    if (!captured->queues.all_join(0)) {
      return device.blame(cudaErrorStreamCaptureUnjoined,
                          "capture: work of another stream is not waited for at its end");
    }
    *graph = captured.release();
    return cudaSuccess;
  });
}

cudaError_t cudaStreamIsCapturing(cudaStream_t stream, cudaStreamCaptureStatus* status) {
  return call([&](Runtime& device) {
    const CUgraph_st* capture = device.at(stream).capture;
    *status = capture == nullptr ? cudaStreamCaptureStatusNone
              : capture->invalid ? cudaStreamCaptureStatusInvalidated
                                 : cudaStreamCaptureStatusActive;
    return cudaSuccess;
  });
}

cudaError_t cudaGraphInstantiate(cudaGraphExec_t* executable, cudaGraph_t graph, unsigned long long) {
  return call([&](Runtime&) {
    if (graph == nullptr) return cudaErrorInvalidValue;
    *executable = new CUgraphExec_st{graph->queues};
    return cudaSuccess;
  });
}

cudaError_t cudaGraphInstantiateWithFlags(cudaGraphExec_t* executable, cudaGraph_t graph, unsigned long long flags) {
  return cudaGraphInstantiate(executable, graph, flags);
}

cudaError_t cudaGraphLaunch(cudaGraphExec_t executable, cudaStream_t stream) {
  return call([&](Runtime& device) {
    if (executable == nullptr) return cudaErrorInvalidValue;
    if (device.at(stream).capture != nullptr) return cudaErrorStreamCaptureUnsupported;
    Operation launch;
    launch.execute = [queues = executable->queues]() mutable { queues.run(queues.end_of(0)); };
    device.push(stream, std::move(launch));
    return cudaSuccess;
  });
}

cudaError_t cudaGraphExecDestroy(cudaGraphExec_t executable) {
  const std::lock_guard<std::mutex> turn(runtime().mutex);
  delete executable;
  return cudaSuccess;
}

cudaError_t cudaGraphDestroy(cudaGraph_t graph) {
  const std::lock_guard<std::mutex> turn(runtime().mutex);
  delete graph;
  return cudaSuccess;
}
