// SPDX-License-Identifier: MIT
// What a probe of devices finds on machines with a device, without one, and without a driver.
#include <cuda_runtime.h>
#include <gtest/gtest.h>

#include <string>

namespace {

__global__ void nothing() {}

class Device : public testing::Test {
 protected:
  ~Device() override {
    rptv::cuda_host::set_machine(CUDART_VERSION, 1);
    rptv::cuda_host::forget_faults();
  }
};

TEST_F(Device, is_the_smallest_that_is_supported) {
  int count = 0;
  EXPECT_EQ(cudaGetDeviceCount(&count), cudaSuccess);
  EXPECT_EQ(count, 1);
  EXPECT_EQ(cudaSetDevice(0), cudaSuccess);
  cudaDeviceProp properties;
  ASSERT_EQ(cudaGetDeviceProperties(&properties, 0), cudaSuccess);
  EXPECT_EQ(properties.major * 10 + properties.minor, 75);
  EXPECT_EQ(properties.sharedMemPerBlock, 49152u);
  int threads = 0;
  EXPECT_EQ(cudaDeviceGetAttribute(&threads, cudaDevAttrMaxThreadsPerBlock, 0), cudaSuccess);
  EXPECT_EQ(threads, properties.maxThreadsPerBlock);
  cudaFuncAttributes attributes;
  EXPECT_EQ(cudaFuncGetAttributes(&attributes, nothing), cudaSuccess);
  EXPECT_EQ(attributes.maxDynamicSharedSizeBytes, 49152);
}

TEST_F(Device, is_missing) {
  rptv::cuda_host::set_machine(CUDART_VERSION, 0);
  int count = -1;
  EXPECT_EQ(cudaGetDeviceCount(&count), cudaErrorNoDevice);
  EXPECT_EQ(count, 0);
  EXPECT_EQ(cudaSetDevice(0), cudaErrorNoDevice);
  EXPECT_EQ(cudaGetLastError(), cudaErrorNoDevice);
  EXPECT_EQ(cudaGetLastError(), cudaSuccess);
}

TEST_F(Device, is_another_than_asked_for) { EXPECT_EQ(cudaSetDevice(1), cudaErrorInvalidDevice); }

TEST_F(Device, has_no_driver_or_an_old_one) {
  for (const int version : {0, 11080}) {
    rptv::cuda_host::set_machine(version, 1);
    int found = -1;
    EXPECT_EQ(cudaDriverGetVersion(&found), cudaSuccess);
    EXPECT_EQ(found, version);
    int count = -1;
    EXPECT_EQ(cudaGetDeviceCount(&count), cudaErrorInsufficientDriver);
    EXPECT_STREQ(cudaGetErrorName(cudaGetLastError()), "cudaErrorInsufficientDriver");
  }
}

}  // namespace
