// SPDX-License-Identifier: MIT
// Correct kernels on the executor: reduction, histogram, ballots and shuffles, for several block sizes and schedules.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "reconstruct/cuda_device.hpp"
#include "tests/cuda_host/device_values.hpp"

namespace {

using rptv::cuda_host::DeviceValues;

__global__ void block_sums(const int* values, int count, long long* sums) {
  RPTV_SHARED(int, of_warp, [32]);
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  int sum = i < count ? values[i] : 0;
  for (unsigned step = 16; step > 0; step /= 2) sum += __shfl_down_sync(0xffffffffu, sum, step);
  if (threadIdx.x % 32 == 0) of_warp[threadIdx.x / 32] = sum;
  __syncthreads();
  if (threadIdx.x != 0) return;
  long long total = 0;
  for (unsigned warp = 0; warp < blockDim.x / 32; ++warp) total += of_warp[warp];
  sums[blockIdx.x] = total;
}

__global__ void histogram(const unsigned* values, int count, unsigned* bins) {
  RPTV_DYNAMIC_SHARED(unsigned, mine);
  for (unsigned bin = threadIdx.x; bin < 64; bin += blockDim.x) mine[bin] = 0;
  __syncthreads();
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < count) atomicAdd(&mine[values[i] % 64], 1u);
  __syncthreads();
  for (unsigned bin = threadIdx.x; bin < 64; bin += blockDim.x) atomicAdd(&bins[bin], mine[bin]);
}

__global__ void keep_odd(const int* values, int count, int* kept, int* kept_count) {
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  const bool odd = i < count && (values[i] & 1) != 0;
  const unsigned lanes = __ballot_sync(0xffffffffu, odd);
  const int lane = static_cast<int>(threadIdx.x % 32);
  int first = 0;
  if (lane == 0 && lanes != 0) first = atomicAdd(kept_count, __popc(lanes));
  first = __shfl_sync(0xffffffffu, first, 0);
  if (odd) kept[first + __popc(lanes & ((1u << lane) - 1u))] = values[i];
}

struct Schedule {
  unsigned block_size;
  std::uint64_t seed;
};

class Kernels : public testing::TestWithParam<Schedule> {
 protected:
  Kernels() { rptv::cuda_host::set_schedule_seed(GetParam().seed); }
  ~Kernels() override { rptv::cuda_host::set_schedule_seed(0); }

  cudaLaunchConfig_t config(std::size_t items, std::size_t dynamic_bytes = 0) const {
    cudaLaunchConfig_t launch{};
    launch.gridDim = static_cast<unsigned>((items + GetParam().block_size - 1) / GetParam().block_size);
    launch.blockDim = GetParam().block_size;
    launch.dynamicSmemBytes = dynamic_bytes;
    return launch;
  }
};

TEST_P(Kernels, sum_by_shuffles_and_a_barrier) {
  std::vector<int> values(1000);
  std::iota(values.begin(), values.end(), -300);
  const DeviceValues<int> device_values(values);
  const cudaLaunchConfig_t launch = config(values.size());
  const DeviceValues<long long> sums(std::vector<long long>(launch.gridDim.x, 0));
  ASSERT_EQ(cudaLaunchKernelEx(&launch, block_sums, device_values.get(), 1000, sums.get()), cudaSuccess);
  const std::vector<long long> found = sums.read();
  EXPECT_EQ(std::accumulate(found.begin(), found.end(), 0LL), 1000LL * 999 / 2 - 300 * 1000)
      << rptv::cuda_host::last_fault();
}

TEST_P(Kernels, count_into_shared_memory) {
  std::vector<unsigned> values(777);
  for (unsigned i = 0; i < values.size(); ++i) values[i] = i * i;
  std::vector<unsigned> expected(64, 0);
  for (const unsigned value : values) ++expected[value % 64];
  const DeviceValues<unsigned> device_values(values);
  const DeviceValues<unsigned> bins(std::vector<unsigned>(64, 0));
  const cudaLaunchConfig_t launch = config(values.size(), 64 * sizeof(unsigned));
  ASSERT_EQ(cudaLaunchKernelEx(&launch, histogram, device_values.get(), 777, bins.get()), cudaSuccess);
  EXPECT_EQ(bins.read(), expected) << rptv::cuda_host::last_fault();
}

TEST_P(Kernels, append_by_ballot) {
  std::vector<int> values(500);
  std::iota(values.begin(), values.end(), 0);
  const DeviceValues<int> device_values(values);
  const DeviceValues<int> kept(std::vector<int>(250, -1));
  const DeviceValues<int> count(std::vector<int>(1, 0));
  const cudaLaunchConfig_t launch = config(values.size());
  ASSERT_EQ(cudaLaunchKernelEx(&launch, keep_odd, device_values.get(), 500, kept.get(), count.get()), cudaSuccess);
  EXPECT_EQ(count.read()[0], 250) << rptv::cuda_host::last_fault();
  std::vector<int> found = kept.read();
  std::sort(found.begin(), found.end());
  for (int i = 0; i < 250; ++i) EXPECT_EQ(found[static_cast<std::size_t>(i)], 2 * i + 1);
}

INSTANTIATE_TEST_SUITE_P(schedules, Kernels,
                         testing::Values(Schedule{32, 0}, Schedule{96, 0}, Schedule{96, 5}, Schedule{256, 7}));

}  // namespace
