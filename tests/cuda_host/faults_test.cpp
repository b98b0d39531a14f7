// SPDX-License-Identifier: MIT
// Kernels and launches at fault: the call returns CUDA's error and last_fault() says where and why.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "reconstruct/cuda_device.hpp"
#include "tests/cuda_host/device_values.hpp"
#include "tests/cuda_host/launch_config.hpp"

namespace {

using rptv::cuda_host::DeviceValues;
using rptv::cuda_host::launch_of;
using testing::AllOf;
using testing::HasSubstr;

__global__ void divergent_barrier(int* seen) {
  if (threadIdx.x < 32) {
    __syncthreads();
  } else {
    __syncthreads();
    seen[threadIdx.x] = 1;
  }
}
constexpr int kFirstBarrierLine = __LINE__ - 6;

__global__ void leaves_before_the_barrier(int* seen, unsigned count) {
  if (threadIdx.x >= count) return;
  __syncthreads();
  seen[threadIdx.x] = 1;
}

__global__ void mask_without_itself(int*) { __syncwarp(0x0000ffffu); }

__global__ void warp_meets_in_two_places(int* seen) {
  const bool low = threadIdx.x < 16;
  if (low) seen[0] = __shfl_sync(0xffffffffu, 1, 0);
  if (!low) seen[1] = __shfl_sync(0xffffffffu, 1, 0);
}

__global__ void shuffle_from_a_lane_that_left(int* seen) {
  if (threadIdx.x == 0) return;
  seen[threadIdx.x] = __shfl_sync(0xffffffffu, 1, 0);
}

__global__ void traps(int* seen) {
  if (seen[0] == 0) __trap();
}

__global__ void too_much_shared_memory(int* seen) {
  RPTV_SHARED(int, small, [1024]);
  RPTV_SHARED(int, large, [12 * 1024]);
  small[threadIdx.x] = large[threadIdx.x] = seen[0];
}

__global__ void one(int* seen) {
  if (blockIdx.x == 0 && threadIdx.x == 0) seen[0] = 1;
}

template <int bytes>
struct Arguments {
  char data[bytes];
};
__global__ void takes_much(Arguments<4000>, int* seen) { seen[0] = 2; }

class Faults : public testing::Test {
 protected:
  ~Faults() override { rptv::cuda_host::forget_faults(); }

  template <class... Parameters, class... Values>
  static std::string fault_of(const cudaLaunchConfig_t& launch, void (*kernel)(Parameters...), Values... values) {
    EXPECT_EQ(cudaLaunchKernelEx(&launch, kernel, values...), cudaSuccess);
    EXPECT_EQ(cudaDeviceSynchronize(), cudaErrorLaunchFailure);
    return rptv::cuda_host::last_fault();
  }

  template <class... Values>
  static std::string refusal_of(const cudaLaunchConfig_t& launch, cudaError_t expected, Values... values) {
    EXPECT_EQ(cudaLaunchKernelEx(&launch, values...), expected);
    EXPECT_EQ(cudaGetLastError(), expected);
    return rptv::cuda_host::last_fault();
  }

  const DeviceValues<int> seen_{std::vector<int>(1024, 0)};
};

TEST_F(Faults, divergent_barrier_is_named_by_its_lines) {
  const std::string fault = fault_of(launch_of(1, 64), divergent_barrier, seen_.get());
  EXPECT_THAT(fault,
              AllOf(HasSubstr("block (0,0,0)"), HasSubstr("faults_test.cpp:" + std::to_string(kFirstBarrierLine)),
                    HasSubstr("faults_test.cpp:" + std::to_string(kFirstBarrierLine + 2))));
}

TEST_F(Faults, thread_that_left_is_missed_at_a_barrier) {
  EXPECT_THAT(fault_of(launch_of(1, 64), leaves_before_the_barrier, seen_.get(), 50u),
              AllOf(HasSubstr("50 at the block's meeting"), HasSubstr("14 have left the kernel")));
}

TEST_F(Faults, mask_that_leaves_out_its_own_lane) {
  EXPECT_THAT(fault_of(launch_of(1, 32), mask_without_itself, seen_.get()), HasSubstr("leaves out lane 16 itself"));
}

TEST_F(Faults, lanes_that_meet_in_different_calls) {
  EXPECT_THAT(fault_of(launch_of(1, 32), warp_meets_in_two_places, seen_.get()), HasSubstr("meet in different calls"));
}

TEST_F(Faults, shuffle_that_reads_a_lane_that_left) {
  EXPECT_THAT(fault_of(launch_of(1, 32), shuffle_from_a_lane_that_left, seen_.get()), HasSubstr("reads lane 0"));
}

TEST_F(Faults, trap) { EXPECT_THAT(fault_of(launch_of(1, 32), traps, seen_.get()), HasSubstr("__trap()")); }

TEST_F(Faults, shared_arrays_beyond_48_KiB) {
  EXPECT_THAT(fault_of(launch_of(1, 32), too_much_shared_memory, seen_.get()),
              AllOf(HasSubstr("'large'"), HasSubstr("53248")));
}

TEST_F(Faults, failed_launch_stays_until_forgotten) {
  fault_of(launch_of(1, 32), traps, seen_.get());
  int* more = nullptr;
  EXPECT_EQ(cudaMalloc(&more, 4), cudaErrorLaunchFailure);
  EXPECT_EQ(cudaGetLastError(), cudaErrorLaunchFailure);
  rptv::cuda_host::forget_faults();
  EXPECT_EQ(cudaGetLastError(), cudaSuccess);
  const cudaLaunchConfig_t launch = launch_of(2, 64);
  EXPECT_EQ(cudaLaunchKernelEx(&launch, one, seen_.get()),
            cudaSuccess);  // on fibers of which the fault left some behind
  EXPECT_EQ(seen_.read()[0], 1);
}

TEST_F(Faults, block_of_more_than_1024_threads) {
  EXPECT_THAT(refusal_of(launch_of(1, 1025), cudaErrorInvalidConfiguration, one, seen_.get()),
              HasSubstr("1024 threads"));
}

TEST_F(Faults, empty_grid) {
  EXPECT_THAT(refusal_of(launch_of(0, 32), cudaErrorInvalidConfiguration, one, seen_.get()), HasSubstr("no block"));
}

TEST_F(Faults, grid_that_is_too_high) {
  cudaLaunchConfig_t launch = launch_of(1, 32);
  launch.gridDim.y = 65536;
  EXPECT_THAT(refusal_of(launch, cudaErrorInvalidConfiguration, one, seen_.get()), HasSubstr("larger than"));
}

TEST_F(Faults, dynamic_shared_memory_beyond_48_KiB_unless_asked_for) {
  const cudaLaunchConfig_t launch = launch_of(1, 32, nullptr, 60 * 1024);
  EXPECT_THAT(refusal_of(launch, cudaErrorInvalidConfiguration, one, seen_.get()), HasSubstr("61440"));
  EXPECT_EQ(cudaFuncSetAttribute(one, cudaFuncAttributeMaxDynamicSharedMemorySize, 60 * 1024), cudaSuccess);
  EXPECT_EQ(cudaLaunchKernelEx(&launch, one, seen_.get()), cudaSuccess);
  EXPECT_EQ(seen_.read()[0], 1);
  EXPECT_EQ(cudaFuncSetAttribute(one, cudaFuncAttributeMaxDynamicSharedMemorySize, 65537), cudaErrorInvalidValue);
}

TEST_F(Faults, argument_that_only_the_host_has) {
  int on_host = 0;
  EXPECT_THAT(refusal_of(launch_of(1, 32), cudaErrorInvalidValue, one, &on_host), HasSubstr("argument 0"));
}

TEST_F(Faults, none_for_many_bytes_of_arguments) {
  const cudaLaunchConfig_t launch = launch_of(1, 1);
  EXPECT_EQ(cudaLaunchKernelEx(&launch, takes_much, Arguments<4000>{}, seen_.get()), cudaSuccess);
  EXPECT_EQ(seen_.read()[0], 2);
}

}  // namespace
