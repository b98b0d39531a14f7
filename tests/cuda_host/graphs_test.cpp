// SPDX-License-Identifier: MIT
// Graphs by capture: what they repeat, and what may not be captured.
#include <gtest/gtest.h>

#include <vector>

#include "reconstruct/cuda_device.hpp"
#include "tests/cuda_host/device_values.hpp"
#include "tests/cuda_host/launch_config.hpp"

namespace {

using rptv::cuda_host::DeviceValues;
using rptv::cuda_host::launch_of;

__global__ void twice(int* to, const int* from, unsigned count) {
  const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count) to[i] = 2 * from[i];
}

__global__ void sum(int* to, const int* a, const int* b, unsigned count) {
  const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count) to[i] = a[i] + b[i];
}

class Graphs : public testing::Test {
 protected:
  Graphs() {
    cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking);
    cudaStreamCreateWithFlags(&other_, cudaStreamNonBlocking);
    cudaEventCreateWithFlags(&fork_, cudaEventDisableTiming);
    cudaEventCreateWithFlags(&join_, cudaEventDisableTiming);
    cudaMallocHost(&input_, kBytes);
    cudaMallocHost(&output_, kBytes);
  }
  ~Graphs() override {
    cudaStreamDestroy(stream_);
    cudaStreamDestroy(other_);
    cudaEventDestroy(fork_);
    cudaEventDestroy(join_);
    cudaFreeHost(input_);
    cudaFreeHost(output_);
    rptv::cuda_host::forget_faults();
  }

  void double_on(cudaStream_t stream, const DeviceValues<int>& to, const DeviceValues<int>& from) {
    const cudaLaunchConfig_t launch = launch_of(1, 32, stream);
    EXPECT_EQ(cudaLaunchKernelEx(&launch, twice, to.get(), static_cast<const int*>(from.get()), kCount), cudaSuccess);
  }

  /// input -> a; b = 2a on one stream, c = 2b or 2a on another, output = b + c.
  void capture_diamond(bool join) {
    cudaStreamBeginCapture(stream_, cudaStreamCaptureModeThreadLocal);
    cudaMemcpyAsync(a_.get(), input_, kBytes, cudaMemcpyHostToDevice, stream_);
    cudaEventRecord(fork_, stream_);
    cudaStreamWaitEvent(other_, fork_, 0);
    double_on(other_, c_, a_);
    cudaEventRecord(join_, other_);
    double_on(stream_, b_, a_);
    if (join) cudaStreamWaitEvent(stream_, join_, 0);
    const cudaLaunchConfig_t launch = launch_of(1, 32, stream_);
    cudaLaunchKernelEx(&launch, sum, a_.get(), static_cast<const int*>(b_.get()), static_cast<const int*>(c_.get()),
                       kCount);
    cudaMemcpyAsync(output_, a_.get(), kBytes, cudaMemcpyDeviceToHost, stream_);
  }

  static constexpr unsigned kCount = 20;
  static constexpr std::size_t kBytes = kCount * sizeof(int);
  cudaStream_t stream_{}, other_{};
  cudaEvent_t fork_{}, join_{};
  int *input_ = nullptr, *output_ = nullptr;
  const DeviceValues<int> a_{std::vector<int>(kCount, 0)}, b_{std::vector<int>(kCount, 0)},
      c_{std::vector<int>(kCount, 0)};
};

TEST_F(Graphs, repeat_their_work_with_what_the_memory_holds_then) {
  capture_diamond(true);
  cudaGraph_t graph{};
  ASSERT_EQ(cudaStreamEndCapture(stream_, &graph), cudaSuccess) << rptv::cuda_host::last_fault();
  cudaGraphExec_t executable{};
  ASSERT_EQ(cudaGraphInstantiate(&executable, graph, 0), cudaSuccess);
  ASSERT_EQ(cudaGraphDestroy(graph), cudaSuccess);
  for (int frame = 0; frame < 3; ++frame) {
    for (unsigned i = 0; i < kCount; ++i) input_[i] = frame + static_cast<int>(i);
    ASSERT_EQ(cudaGraphLaunch(executable, stream_), cudaSuccess);
    ASSERT_EQ(cudaStreamSynchronize(stream_), cudaSuccess);
    for (unsigned i = 0; i < kCount; ++i) EXPECT_EQ(output_[i], 4 * (frame + static_cast<int>(i)));
  }
  EXPECT_EQ(cudaGraphExecDestroy(executable), cudaSuccess);
}

TEST_F(Graphs, capture_runs_nothing) {
  const std::vector<int> before = a_.read();
  input_[0] = 5;
  capture_diamond(true);
  cudaStreamCaptureStatus status{};
  EXPECT_EQ(cudaStreamIsCapturing(other_, &status), cudaSuccess);
  EXPECT_EQ(status, cudaStreamCaptureStatusActive);
  cudaGraph_t graph{};
  ASSERT_EQ(cudaStreamEndCapture(stream_, &graph), cudaSuccess);
  cudaStreamIsCapturing(other_, &status);
  EXPECT_EQ(status, cudaStreamCaptureStatusNone);
  EXPECT_EQ(cudaDeviceSynchronize(), cudaSuccess);
  EXPECT_EQ(a_.read(), before);
  cudaGraphDestroy(graph);
}

TEST_F(Graphs, stream_that_is_not_joined_is_an_error) {
  capture_diamond(false);
  cudaGraph_t graph{};
  EXPECT_EQ(cudaStreamEndCapture(stream_, &graph), cudaErrorStreamCaptureUnjoined);
  EXPECT_EQ(graph, nullptr);
}

TEST_F(Graphs, waiting_ends_a_capture) {
  cudaStreamBeginCapture(stream_, cudaStreamCaptureModeGlobal);
  double_on(stream_, b_, a_);
  EXPECT_EQ(cudaStreamSynchronize(stream_), cudaErrorStreamCaptureUnsupported);
  cudaGraph_t graph{};
  EXPECT_EQ(cudaStreamEndCapture(stream_, &graph), cudaErrorStreamCaptureInvalidated);
  EXPECT_EQ(cudaStreamSynchronize(stream_), cudaSuccess);
}

TEST_F(Graphs, pageable_memory_cannot_be_captured) {
  int pageable = 1;
  cudaStreamBeginCapture(stream_, cudaStreamCaptureModeGlobal);
  EXPECT_EQ(cudaMemcpyAsync(a_.get(), &pageable, sizeof pageable, cudaMemcpyHostToDevice, stream_),
            cudaErrorStreamCaptureUnsupported);
  cudaGraph_t graph{};
  EXPECT_EQ(cudaStreamEndCapture(stream_, &graph), cudaSuccess);
  cudaGraph_t again{};
  EXPECT_EQ(cudaStreamEndCapture(stream_, &again), cudaErrorStreamCaptureUnmatched);
  EXPECT_EQ(cudaGraphDestroy(graph), cudaSuccess);
}

TEST_F(Graphs, event_of_a_capture_means_nothing_after_it) {
  capture_diamond(true);
  cudaGraph_t graph{};
  ASSERT_EQ(cudaStreamEndCapture(stream_, &graph), cudaSuccess);
  EXPECT_EQ(cudaStreamWaitEvent(other_, fork_, 0), cudaErrorStreamCaptureUnsupported);
  EXPECT_EQ(cudaEventSynchronize(fork_), cudaErrorStreamCaptureUnsupported);
  cudaGraphDestroy(graph);
}

}  // namespace
