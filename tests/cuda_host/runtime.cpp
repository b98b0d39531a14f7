// SPDX-License-Identifier: MIT
// Queues, runs and blames; the calls for errors and for the executor's own settings.
#include "tests/cuda_host/runtime.hpp"

#include <cstdio>
#include <cstdlib>
#include <utility>

#include "tests/cuda_host/access_fault.hpp"
#include "tests/cuda_host/captured_graph.hpp"
#include "tests/cuda_host/control.hpp"

namespace rptv::cuda_host {

Runtime::Runtime() {
  null_stream.queue = device_queues.add_queue();
  null_stream.blocking = true;
  if (const char* text = std::getenv("RPTV_CUDA_SEED")) seed = std::strtoull(text, nullptr, 10);
  explain_access_faults(memory);
}

Runtime& runtime() {
  static Runtime& the_one = *new Runtime;  // outlives whatever frees device memory at exit
  return the_one;
}

void Runtime::push(cudaStream_t stream, Operation operation) {
  CUstream_st& target = at(stream);
  if (target.capture != nullptr) {
    target.capture->queues.push(target.capture_queue, std::move(operation));
    return;
  }
  if (stream == nullptr) {
    for (const cudaStream_t other : blocking_streams) operation.waits_for.push_back(device_queues.end_of(other->queue));
  } else if (target.blocking) {
    operation.waits_for.push_back(device_queues.end_of(null_stream.queue));
  }
  device_queues.push(target.queue, std::move(operation));
}

Position Runtime::end_of(cudaStream_t stream) {
  const CUstream_st& target = at(stream);
  return target.capture != nullptr ? target.capture->queues.end_of(target.capture_queue)
                                   : device_queues.end_of(target.queue);
}

cudaError_t Runtime::run(Position until) {
  memory.open();
  device_queues.run(until);
  memory.close();
  return launch_failed ? cudaErrorLaunchFailure : cudaSuccess;
}

cudaError_t Runtime::run_all() {
  memory.open();
  device_queues.run_all();
  memory.close();
  return launch_failed ? cudaErrorLaunchFailure : cudaSuccess;
}

cudaError_t Runtime::blame(cudaError_t error, std::string what) {
  fault = std::move(what);
  std::fprintf(stderr, "CUDA on the host: %s\n", fault.c_str());
  return error;
}

void set_schedule_seed(std::uint64_t seed) {
  const std::lock_guard<std::mutex> turn(runtime().mutex);
  runtime().seed = seed;
}

std::string last_fault() {
  const std::lock_guard<std::mutex> turn(runtime().mutex);
  return runtime().fault;
}

void forget_faults() {
  const std::lock_guard<std::mutex> turn(runtime().mutex);
  runtime().fault.clear();
  runtime().launch_failed = false;
  runtime().last_error = cudaSuccess;
}

std::size_t device_bytes_in_use() {
  const std::lock_guard<std::mutex> turn(runtime().mutex);
  return runtime().memory.bytes_in_use();
}

void set_machine(int driver_version, int devices) {
  const std::lock_guard<std::mutex> turn(runtime().mutex);
  runtime().driver_version = driver_version;
  runtime().devices = devices;
}

}  // namespace rptv::cuda_host

using namespace rptv::cuda_host;

cudaError_t cudaPeekAtLastError() {
  const std::lock_guard<std::mutex> turn(runtime().mutex);
  return runtime().launch_failed ? cudaErrorLaunchFailure : runtime().last_error;
}

cudaError_t cudaGetLastError() {
  const std::lock_guard<std::mutex> turn(runtime().mutex);
  return runtime().launch_failed ? cudaErrorLaunchFailure : std::exchange(runtime().last_error, cudaSuccess);
}

#define RPTV_NAME_OF(code) \
  case code:               \
    return #code
const char* cudaGetErrorName(cudaError_t error) {
  switch (error) {
    RPTV_NAME_OF(cudaSuccess);
    RPTV_NAME_OF(cudaErrorInvalidValue);
    RPTV_NAME_OF(cudaErrorMemoryAllocation);
    RPTV_NAME_OF(cudaErrorInitializationError);
    RPTV_NAME_OF(cudaErrorInvalidConfiguration);
    RPTV_NAME_OF(cudaErrorInvalidMemcpyDirection);
    RPTV_NAME_OF(cudaErrorInsufficientDriver);
    RPTV_NAME_OF(cudaErrorInvalidDeviceFunction);
    RPTV_NAME_OF(cudaErrorNoDevice);
    RPTV_NAME_OF(cudaErrorInvalidDevice);
    RPTV_NAME_OF(cudaErrorNoKernelImageForDevice);
    RPTV_NAME_OF(cudaErrorUnsupportedPtxVersion);
    RPTV_NAME_OF(cudaErrorInvalidResourceHandle);
    RPTV_NAME_OF(cudaErrorNotReady);
    RPTV_NAME_OF(cudaErrorIllegalAddress);
    RPTV_NAME_OF(cudaErrorLaunchOutOfResources);
    RPTV_NAME_OF(cudaErrorHostMemoryAlreadyRegistered);
    RPTV_NAME_OF(cudaErrorHostMemoryNotRegistered);
    RPTV_NAME_OF(cudaErrorLaunchFailure);
    RPTV_NAME_OF(cudaErrorStreamCaptureUnsupported);
    RPTV_NAME_OF(cudaErrorStreamCaptureInvalidated);
    RPTV_NAME_OF(cudaErrorStreamCaptureUnmatched);
    RPTV_NAME_OF(cudaErrorStreamCaptureUnjoined);
  }
  return "unrecognized error code";
}
#undef RPTV_NAME_OF

const char* cudaGetErrorString(cudaError_t error) { return cudaGetErrorName(error); }
