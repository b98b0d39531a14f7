// SPDX-License-Identifier: MIT
// The state behind the API: one device, its memory, its queued work, the last error. Any thread may call; calls take
// turns.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>

#include "tests/cuda_host/device_memory.hpp"
#include "tests/cuda_host/error_codes.hpp"
#include "tests/cuda_host/grid.hpp"
#include "tests/cuda_host/operation_queues.hpp"
#include "tests/cuda_host/stream_api.hpp"

/// A stream: a queue of the device or, while it is captured, one of a graph to be.
struct CUstream_st {
  std::size_t queue = 0;
  bool blocking = false;  // takes turns with the null stream
  struct CUgraph_st* capture = nullptr;
  std::size_t capture_queue = 0;
  bool began_capture = false;
  int polls = 0;
};

namespace rptv::cuda_host {

inline constexpr int kPollsUntilReady = 3;

struct Runtime {
  std::mutex mutex;
  OperationQueues device_queues;
  CUstream_st null_stream;
  std::set<cudaStream_t> blocking_streams;
  std::set<const struct CUgraph_st*> captures;  // that have begun and not ended
  DeviceMemory memory;
  PinnedRanges pinned;
  Grid grid;
  std::map<const void*, std::size_t> dynamic_limit_bytes;  // of kernels that asked for more than 48 KiB
  std::uint64_t seed = 0;
  int driver_version = 13000;
  int devices = 1;
  cudaError_t last_error = cudaSuccess;
  bool launch_failed = false;
  std::string fault;

  Runtime();

  CUstream_st& at(cudaStream_t stream) { return stream == nullptr ? null_stream : *stream; }

  /// Queues work on a stream, or adds it to the graph that captures it.
  void push(cudaStream_t stream, Operation operation);
  Position end_of(cudaStream_t stream);

  /// Runs what is queued; device memory is open meanwhile. After a failed launch operations do nothing.
  cudaError_t run(Position until);
  cudaError_t run_all();

  cudaError_t blame(cudaError_t error, std::string what);
};

Runtime& runtime();

/// A call of the API: takes its turn, and keeps its error for cudaGetLastError().
template <class Work>
cudaError_t call(Work work) {
  Runtime& device = runtime();
  const std::lock_guard<std::mutex> turn(device.mutex);
  if (device.launch_failed) return cudaErrorLaunchFailure;
  const cudaError_t error = work(device);
  if (error != cudaSuccess && error != cudaErrorNotReady) device.last_error = error;
  return error;
}

}  // namespace rptv::cuda_host
