// SPDX-License-Identifier: MIT
// Streams: who waits runs what is queued there, and what that waits for.
#include "tests/cuda_host/stream_api.hpp"

#include "tests/cuda_host/captured_graph.hpp"
#include "tests/cuda_host/event.hpp"
#include "tests/cuda_host/runtime.hpp"

using namespace rptv::cuda_host;

namespace {

/// Waiting within a capture ends it.
cudaError_t spoil(CUstream_st& stream) {
  stream.capture->invalid = true;
  return cudaErrorStreamCaptureUnsupported;
}

}  // namespace

cudaError_t cudaStreamCreate(cudaStream_t* stream) { return cudaStreamCreateWithFlags(stream, cudaStreamDefault); }

cudaError_t cudaStreamCreateWithPriority(cudaStream_t* stream, unsigned flags, int) {
  return cudaStreamCreateWithFlags(stream, flags);
}

cudaError_t cudaStreamCreateWithFlags(cudaStream_t* stream, unsigned flags) {
  return call([&](Runtime& device) {
    *stream = new CUstream_st;
    (*stream)->queue = device.device_queues.add_queue();
    (*stream)->blocking = (flags & cudaStreamNonBlocking) == 0;
    if ((*stream)->blocking) device.blocking_streams.insert(*stream);
    return cudaSuccess;
  });
}

cudaError_t cudaStreamDestroy(cudaStream_t stream) {
  const cudaError_t error =
      call([&](Runtime& device) { return device.run(device.device_queues.end_of(device.at(stream).queue)); });
  if (stream == nullptr) return cudaErrorInvalidResourceHandle;
  const std::lock_guard<std::mutex> turn(runtime().mutex);
  runtime().blocking_streams.erase(stream);
  delete stream;
  return error;
}

cudaError_t cudaStreamSynchronize(cudaStream_t stream) {
  return call([&](Runtime& device) {
    if (device.at(stream).capture != nullptr) return spoil(device.at(stream));
    return device.run(device.end_of(stream));
  });
}

cudaError_t cudaDeviceSynchronize() {
  return call([](Runtime& device) { return device.run_all(); });
}

cudaError_t cudaStreamQuery(cudaStream_t stream) {
  return call([&](Runtime& device) {
    CUstream_st& asked = device.at(stream);
    if (asked.capture != nullptr) return spoil(asked);
    const Position end = device.end_of(stream);
    if (!device.device_queues.has_run(end) && ++asked.polls < kPollsUntilReady) return cudaErrorNotReady;
    asked.polls = 0;
    return device.run(end);
  });
}

cudaError_t cudaStreamWaitEvent(cudaStream_t stream, cudaEvent_t event, unsigned) {
  return call([&](Runtime& device) {
    if (event == nullptr) return cudaErrorInvalidResourceHandle;
    if (!event->recorded) return cudaSuccess;
    if (event->graph != nullptr && device.captures.count(event->graph) == 0) return cudaErrorStreamCaptureUnsupported;
    CUstream_st& waiting = device.at(stream);
    if (event->graph != nullptr && waiting.capture == nullptr) {  // the stream joins the capture
      waiting.capture = event->graph;
      waiting.capture_queue = event->graph->queues.add_queue();
      event->graph->joined.push_back(&waiting);
    }
    if (event->graph != waiting.capture) return cudaErrorStreamCaptureUnsupported;
    Operation wait;
    wait.execute = [] {};
    wait.waits_for = {event->position};
    device.push(stream, std::move(wait));
    return cudaSuccess;
  });
}
