// SPDX-License-Identifier: MIT
// Memory that a kernel or the host must not touch: AddressSanitizer names the line; without it pages and marks behind
// arrays tell.
#include <gtest/gtest.h>

#include <vector>

#include "reconstruct/cuda_device.hpp"
#include "tests/cuda_host/device_values.hpp"
#include "tests/cuda_host/launch_config.hpp"

namespace {

using rptv::cuda_host::DeviceValues;
using rptv::cuda_host::launch_of;

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kAddressSanitizer = true;
#else
constexpr bool kAddressSanitizer = false;
#endif

__global__ void one_too_many(int* sums) {
  RPTV_SHARED(int, values, [64]);
  for (unsigned i = threadIdx.x; i <= 64; i += blockDim.x) values[i] = 1;
  __syncthreads();
  sums[threadIdx.x] = values[threadIdx.x];
}

__global__ void past_dynamic(int* sums, unsigned count) {
  RPTV_DYNAMIC_SHARED(int, values);
  values[count] = 1;
  sums[0] = values[0];
}

/// Appends without looking at the list's capacity.
__global__ void append(int* list, int* length) { list[atomicAdd(length, 1)] = 1; }

__global__ void keep(int* kept, const int* values, unsigned count) {
  const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count) kept[i] = values[i];
}

template <class... Parameters, class... Arguments>
cudaError_t run(const cudaLaunchConfig_t& launch, void (*kernel)(Parameters...), Arguments... arguments) {
  const cudaError_t error = cudaLaunchKernelEx(&launch, kernel, arguments...);
  return error == cudaSuccess ? cudaDeviceSynchronize() : error;
}

class Overruns : public testing::Test {
 protected:
  Overruns() { testing::FLAGS_gtest_death_test_style = "fast"; }
  ~Overruns() override { rptv::cuda_host::forget_faults(); }

  /// The launch writes past a shared array of this name.
  template <class Launch>
  static void expect_overrun_of(const std::string& array, Launch launch) {
    if (kAddressSanitizer) {
      EXPECT_DEATH(launch(), "(heap-buffer-overflow(.|\n)*overruns_test.cpp|overruns_test.cpp.*out of bounds)");
      return;
    }
    EXPECT_EQ(launch(), cudaErrorLaunchFailure);
    EXPECT_NE(rptv::cuda_host::last_fault().find("past the end of '" + array + "'"), std::string::npos);
  }

  const DeviceValues<int> sums_{std::vector<int>(64, 0)};
  const DeviceValues<int> length_{std::vector<int>(1, 0)};
};

TEST_F(Overruns, shared_array_by_one) {
  expect_overrun_of("values", [&] { return run(launch_of(1, 64), one_too_many, sums_.get()); });
}

TEST_F(Overruns, dynamic_shared_memory) {
  expect_overrun_of("dynamic shared memory",
                    [&] { return run(launch_of(1, 1, nullptr, 64 * sizeof(int)), past_dynamic, sums_.get(), 64u); });
}

TEST_F(Overruns, append_by_one) {
  if (!kAddressSanitizer)
    GTEST_SKIP() << "one value past device memory is seen by the AddressSanitizer build (cmake --preset asan)";
  EXPECT_DEATH(run(launch_of(1, 65), append, sums_.get(), length_.get()), "use-after-poison(.|\n)*overruns_test.cpp");
}

TEST_F(Overruns, append_past_the_page) {
  EXPECT_DEATH(run(launch_of(2, 1024), append, sums_.get(), length_.get()),
               kAddressSanitizer ? "use-after-poison" : "leaves its device memory: offset 256 of a block of 256 bytes");
}

TEST_F(Overruns, freed_device_memory) {
  int* freed = nullptr;
  ASSERT_EQ(cudaMalloc(&freed, 4096), cudaSuccess);
  ASSERT_EQ(cudaFree(freed), cudaSuccess);
  EXPECT_EQ(run(launch_of(1, 1), append, freed, length_.get()), cudaErrorInvalidValue);
  EXPECT_EQ(cudaFree(freed), cudaErrorInvalidValue);
  EXPECT_EQ(cudaMemsetAsync(freed, 0, 1), cudaErrorInvalidValue);
}

TEST_F(Overruns, host_reads_device_memory) {
  volatile int sum = 0;
  EXPECT_DEATH(sum = sum + sums_.get()[3], kAddressSanitizer ? "use-after-poison(.|\n)*overruns_test.cpp"
                                                             : "host touches device memory: offset 12 of");
}

TEST_F(Overruns, copies_past_the_end_or_in_the_wrong_direction_are_refused) {
  std::vector<int> values(65, 1);
  EXPECT_EQ(cudaMemcpy(sums_.get(), values.data(), 65 * sizeof(int), cudaMemcpyHostToDevice), cudaErrorInvalidValue);
  EXPECT_EQ(cudaMemcpy(values.data(), sums_.get() + 1, 64 * sizeof(int), cudaMemcpyDeviceToHost),
            cudaErrorInvalidValue);
  EXPECT_EQ(cudaMemcpy(sums_.get(), values.data(), 4, cudaMemcpyDeviceToHost), cudaErrorInvalidValue);
  EXPECT_EQ(cudaMemset(sums_.get(), 0, 65 * sizeof(int)), cudaErrorInvalidValue);
  EXPECT_EQ(cudaMemset(sums_.get(), 0, 64 * sizeof(int)), cudaSuccess);
}

TEST_F(Overruns, lost_last_block_leaves_its_values_undefined) {
  const DeviceValues<int> values(std::vector<int>(70, 1));
  int* kept = nullptr;
  ASSERT_EQ(cudaMalloc(&kept, 70 * sizeof(int)), cudaSuccess);
  ASSERT_EQ(run(launch_of(70 / 32, 32), keep, kept, values.get(), 70u), cudaSuccess);  // should be rounded up
  std::vector<unsigned> found(70);
  cudaMemcpy(found.data(), kept, 70 * sizeof(int), cudaMemcpyDeviceToHost);
  EXPECT_EQ(found[63], 1u);
  EXPECT_EQ(found[64], 0xA5A5A5A5u);
  ASSERT_EQ(run(launch_of((70 + 31) / 32, 32), keep, kept, values.get(), 70u), cudaSuccess);
  EXPECT_EQ(cudaMemcpy(found.data(), kept, 70 * sizeof(int), cudaMemcpyDeviceToHost), cudaSuccess);
  EXPECT_EQ(found, std::vector<unsigned>(70, 1));
  EXPECT_EQ(cudaFree(kept), cudaSuccess);
}

TEST(DeviceMemory, is_all_given_back) {
  const std::size_t before = rptv::cuda_host::device_bytes_in_use();
  {
    const DeviceValues<int> values(std::vector<int>(10, 1));
    EXPECT_EQ(rptv::cuda_host::device_bytes_in_use(), before + 40);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(values.get()) % 256, 0u);
  }
  EXPECT_EQ(rptv::cuda_host::device_bytes_in_use(), before);
}

}  // namespace
