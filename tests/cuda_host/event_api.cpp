// SPDX-License-Identifier: MIT
// Events: recorded in a stream, waited for by the host or by other streams.
#include "tests/cuda_host/event.hpp"
#include "tests/cuda_host/runtime.hpp"

using namespace rptv::cuda_host;

cudaError_t cudaEventCreate(cudaEvent_t* event) { return cudaEventCreateWithFlags(event, cudaEventDefault); }

cudaError_t cudaEventCreateWithFlags(cudaEvent_t* event, unsigned flags) {
  return call([&](Runtime&) {
    *event = new CUevent_st;
    (*event)->times = (flags & cudaEventDisableTiming) == 0;
    return cudaSuccess;
  });
}

cudaError_t cudaEventDestroy(cudaEvent_t event) {
  if (event == nullptr) return cudaErrorInvalidResourceHandle;
  const std::lock_guard<std::mutex> turn(runtime().mutex);
  delete event;
  return cudaSuccess;
}

cudaError_t cudaEventRecord(cudaEvent_t event, cudaStream_t stream) {
  return call([&](Runtime& device) {
    if (event == nullptr) return cudaErrorInvalidResourceHandle;
    auto passed = std::make_shared<std::chrono::steady_clock::time_point>();
    Operation record;
    record.execute = [passed] { *passed = std::chrono::steady_clock::now(); };
    device.push(stream, std::move(record));
    event->passed = std::move(passed);
    event->position = device.end_of(stream);
    event->graph = device.at(stream).capture;
    event->recorded = true;
    event->polls = 0;
    return cudaSuccess;
  });
}

cudaError_t cudaEventSynchronize(cudaEvent_t event) {
  return call([&](Runtime& device) {
    if (event == nullptr) return cudaErrorInvalidResourceHandle;
    if (event->graph != nullptr) return cudaErrorStreamCaptureUnsupported;
    return event->recorded ? device.run(event->position) : cudaSuccess;
  });
}

cudaError_t cudaEventQuery(cudaEvent_t event) {
  return call([&](Runtime& device) {
    if (event == nullptr) return cudaErrorInvalidResourceHandle;
    if (event->graph != nullptr) return cudaErrorStreamCaptureUnsupported;
    if (!event->recorded || device.device_queues.has_run(event->position)) return cudaSuccess;
    if (++event->polls < kPollsUntilReady) return cudaErrorNotReady;
    return device.run(event->position);
  });
}

cudaError_t cudaEventElapsedTime(float* elapsed_ms, cudaEvent_t begin, cudaEvent_t end) {
  return call([&](Runtime& device) {
    for (const CUevent_st* event : {begin, end}) {
      if (event == nullptr || !event->recorded || !event->times || event->graph != nullptr)
        return cudaErrorInvalidResourceHandle;
      if (!device.device_queues.has_run(event->position)) return cudaErrorNotReady;
    }
    *elapsed_ms = std::chrono::duration<float, std::milli>(*end->passed - *begin->passed).count();
    return cudaSuccess;
  });
}
