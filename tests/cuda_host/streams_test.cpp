// SPDX-License-Identifier: MIT
// Streams and events: work waits until it is waited for, so that a wait that is missing shows as a wrong value.
#include <gtest/gtest.h>

#include <cstdlib>
#include <thread>
#include <vector>

#include "reconstruct/cuda_device.hpp"
#include "tests/cuda_host/device_values.hpp"
#include "tests/cuda_host/launch_config.hpp"

namespace {

using rptv::cuda_host::DeviceValues;
using rptv::cuda_host::launch_of;

__global__ void add_one(int* values, unsigned count) {
  const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count) values[i] += 1;
}

/// A ring as the pipeline has it: pinned slots, uploads on one stream, kernels on another, results copied back.
class Ring {
 public:
  static constexpr int kSlots = 3;
  static constexpr unsigned kCount = 40;
  static constexpr std::size_t kBytes = kCount * sizeof(int);

  Ring() {
    cudaStreamCreateWithFlags(&upload_, cudaStreamNonBlocking);
    cudaStreamCreateWithFlags(&compute_, cudaStreamNonBlocking);
    for (int i = 0; i < kSlots; ++i) {
      cudaMallocHost(&slots_[i], kBytes);
      cudaMallocHost(&results_[i], kBytes);
      cudaMalloc(&on_device_[i], kBytes);
      cudaEventCreateWithFlags(&uploaded_[i], cudaEventDisableTiming);
      cudaEventCreateWithFlags(&done_[i], cudaEventDisableTiming);
    }
  }
  ~Ring() {
    for (int i = 0; i < kSlots; ++i) {
      cudaFreeHost(slots_[i]);
      cudaFreeHost(results_[i]);
      cudaFree(on_device_[i]);
      cudaEventDestroy(uploaded_[i]);
      cudaEventDestroy(done_[i]);
    }
    cudaStreamDestroy(upload_);
    cudaStreamDestroy(compute_);
  }

  void fill(int slot, int value) {
    for (unsigned i = 0; i < kCount; ++i) slots_[slot][i] = value;
  }
  /// Queues upload, kernel and download of a slot that holds `value` everywhere.
  void give(int slot, int value, bool wait_for_upload = true) {
    fill(slot, value);
    cudaMemcpyAsync(on_device_[slot], slots_[slot], kBytes, cudaMemcpyHostToDevice, upload_);
    cudaEventRecord(uploaded_[slot], upload_);
    if (wait_for_upload) cudaStreamWaitEvent(compute_, uploaded_[slot], 0);
    const cudaLaunchConfig_t launch = launch_of(2, 32, compute_);
    cudaLaunchKernelEx(&launch, add_one, on_device_[slot], kCount);
    cudaMemcpyAsync(results_[slot], on_device_[slot], kBytes, cudaMemcpyDeviceToHost, compute_);
    cudaEventRecord(done_[slot], compute_);
  }
  void wait_until_uploaded(int slot) { cudaEventSynchronize(uploaded_[slot]); }
  cudaError_t wait_until_done(int slot) { return cudaEventSynchronize(done_[slot]); }
  cudaError_t poll(int slot) { return cudaEventQuery(done_[slot]); }
  std::vector<int> result(int slot) const { return {results_[slot], results_[slot] + kCount}; }

 private:
  cudaStream_t upload_{}, compute_{};
  int *slots_[kSlots]{}, *results_[kSlots]{}, *on_device_[kSlots]{};
  cudaEvent_t uploaded_[kSlots]{}, done_[kSlots]{};
};

std::vector<int> all(int value) { return std::vector<int>(Ring::kCount, value); }

TEST(Streams, ring_returns_what_was_given) {
  Ring ring;
  for (int frame = 0; frame < 20; ++frame) {
    const int slot = frame % Ring::kSlots;
    if (frame >= Ring::kSlots) {
      ASSERT_EQ(ring.wait_until_done(slot), cudaSuccess);
      EXPECT_EQ(ring.result(slot), all(frame - Ring::kSlots + 1));
    }
    ring.give(slot, frame);
  }
}

/// What comes of a slot that held 1 and is refilled with 50.
std::vector<int> result_of_refilled_slot(bool after_upload) {
  Ring ring;
  ring.give(0, 1);
  if (after_upload) ring.wait_until_uploaded(0);
  ring.fill(0, 50);
  ring.wait_until_done(0);
  return ring.result(0);
}

TEST(Streams, slot_may_be_refilled_when_its_upload_has_passed) { EXPECT_EQ(result_of_refilled_slot(true), all(2)); }

TEST(Streams, slot_that_is_refilled_early_shows) { EXPECT_EQ(result_of_refilled_slot(false), all(51)); }

TEST(Streams, missing_wait_between_streams_shows) {
  Ring ring;
  ring.give(0, 1, false);
  ring.wait_until_done(0);
  EXPECT_NE(ring.result(0), all(2));
}

TEST(Streams, result_that_is_read_early_shows) {
  Ring ring;
  ring.give(0, 1);
  EXPECT_NE(ring.result(0), all(2));
  ring.wait_until_done(0);
  EXPECT_EQ(ring.result(0), all(2));
}

TEST(Streams, polling_sees_both_answers) {
  Ring ring;
  ring.give(0, 1);
  EXPECT_EQ(ring.poll(0), cudaErrorNotReady);
  int polls = 1;
  while (ring.poll(0) == cudaErrorNotReady && polls < 100) ++polls;
  EXPECT_LT(polls, 100);
  EXPECT_EQ(ring.result(0), all(2));
  EXPECT_EQ(cudaGetLastError(), cudaSuccess);
}

TEST(Streams, event_stands_for_its_last_record) {
  int* count = nullptr;
  cudaMallocHost(&count, sizeof(int));
  const DeviceValues<int> value(std::vector<int>(1, 0));
  cudaStream_t stream{};
  cudaEvent_t event{};
  cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking);
  cudaEventCreate(&event);
  EXPECT_EQ(cudaEventSynchronize(event), cudaSuccess);  // nothing recorded: nothing to wait for
  const cudaLaunchConfig_t launch = launch_of(1, 1, stream);
  for (int i = 0; i < 2; ++i) {
    cudaLaunchKernelEx(&launch, add_one, value.get(), 1u);
    cudaMemcpyAsync(count, value.get(), sizeof(int), cudaMemcpyDeviceToHost, stream);
    cudaEventRecord(event, stream);
  }
  cudaEventSynchronize(event);
  EXPECT_EQ(*count, 2);
  cudaEventDestroy(event);
  cudaStreamDestroy(stream);
  cudaFreeHost(count);
}

TEST(Streams, null_stream_takes_turns_with_blocking_streams_only) {
  const DeviceValues<int> value(std::vector<int>(1, 0));
  cudaStream_t blocking{}, free{};
  cudaStreamCreate(&blocking);
  cudaStreamCreateWithFlags(&free, cudaStreamNonBlocking);
  cudaMemsetAsync(value.get(), 1, 1, blocking);
  EXPECT_EQ(value.read()[0], 1);
  cudaMemsetAsync(value.get(), 2, 1, free);
  EXPECT_EQ(value.read()[0], 1);
  cudaStreamSynchronize(free);
  EXPECT_EQ(value.read()[0], 2);
  cudaStreamDestroy(blocking);
  cudaStreamDestroy(free);
}

TEST(Streams, pageable_memory_is_copied_before_the_call_returns) {
  std::vector<int> values{1, 2, 3};
  const DeviceValues<int> on_device(std::vector<int>(3, 0));
  cudaMemcpyAsync(on_device.get(), values.data(), 12, cudaMemcpyHostToDevice, nullptr);
  values = {7, 7, 7};
  EXPECT_EQ(on_device.read(), (std::vector<int>{1, 2, 3}));
}

TEST(Streams, registered_range_is_held_while_a_copy_is_under_way) {
  std::vector<int> values{1, 2, 3};
  const DeviceValues<int> on_device(std::vector<int>(3, 0));
  ASSERT_EQ(cudaHostRegister(values.data(), 12, cudaHostRegisterDefault), cudaSuccess);
  EXPECT_EQ(cudaHostRegister(values.data(), 12, cudaHostRegisterDefault), cudaErrorHostMemoryAlreadyRegistered);
  cudaMemcpyAsync(on_device.get(), values.data(), 12, cudaMemcpyHostToDevice, nullptr);
  EXPECT_EQ(cudaHostUnregister(values.data()), cudaErrorInvalidValue);
  EXPECT_EQ(on_device.read(), values);
  EXPECT_EQ(cudaHostUnregister(values.data()), cudaSuccess);
  EXPECT_EQ(cudaHostUnregister(values.data()), cudaErrorHostMemoryNotRegistered);
  rptv::cuda_host::forget_faults();
}

TEST(Streams, rows_are_copied_at_their_distances) {
  const std::vector<int> image{1, 2, 3, 9, 4, 5, 6, 9};  // two rows of three, four apart
  const DeviceValues<int> packed(std::vector<int>(6, 0));
  ASSERT_EQ(cudaMemcpy2DAsync(packed.get(), 12, image.data(), 16, 12, 2, cudaMemcpyHostToDevice, nullptr), cudaSuccess);
  EXPECT_EQ(packed.read(), (std::vector<int>{1, 2, 3, 4, 5, 6}));
}

TEST(Streams, time_between_events_is_measured_where_asked_for) {
  cudaEvent_t begin{}, end{}, untimed{};
  cudaEventCreate(&begin);
  cudaEventCreate(&end);
  cudaEventCreateWithFlags(&untimed, cudaEventDisableTiming);
  cudaEventRecord(begin);
  cudaEventRecord(end);
  cudaEventRecord(untimed);
  float elapsed_ms = -1;
  EXPECT_EQ(cudaEventElapsedTime(&elapsed_ms, begin, end), cudaErrorNotReady);
  cudaDeviceSynchronize();
  EXPECT_EQ(cudaEventElapsedTime(&elapsed_ms, begin, end), cudaSuccess);
  EXPECT_GE(elapsed_ms, 0.0f);
  EXPECT_EQ(cudaEventElapsedTime(&elapsed_ms, begin, untimed), cudaErrorInvalidResourceHandle);
  for (cudaEvent_t event : {begin, end, untimed}) cudaEventDestroy(event);
  cudaGetLastError();
}

TEST(Streams, threads_of_the_host_share_the_device) {
  std::vector<std::thread> threads;
  std::vector<int> wrong(3, 0);
  for (std::size_t t = 0; t < wrong.size(); ++t) {
    threads.emplace_back([&wrong, t] {
      Ring ring;
      for (int frame = 0; frame < 10; ++frame) {
        ring.give(0, frame);
        ring.wait_until_done(0);
        if (ring.result(0) != all(frame + 1)) ++wrong[t];
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<int>(3, 0));
}

}  // namespace
