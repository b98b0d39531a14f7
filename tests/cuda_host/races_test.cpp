// SPDX-License-Identifier: MIT
// Kernels with a race in them: ThreadSanitizer must name each, whatever the schedule, and must not name the correct
// ones.
#include <gtest/gtest.h>

#include <cstdlib>
#include <vector>

#include "reconstruct/cuda_device.hpp"
#include "tests/cuda_host/device_values.hpp"
#include "tests/cuda_host/launch_config.hpp"

namespace {

using rptv::cuda_host::DeviceValues;
using rptv::cuda_host::launch_of;

enum class Bug { kNone, kBarrierAfterZeroing, kBarrierBeforeReadOut, kPlainSum };

/// Counts values modulo 64 in shared memory, and adds that to `bins`.
template <Bug bug>
__global__ void histogram(const unsigned* values, int count, unsigned* bins) {
  RPTV_SHARED(unsigned, mine, [64]);
  for (unsigned bin = threadIdx.x; bin < 64; bin += blockDim.x) mine[bin] = 0;
  if (bug != Bug::kBarrierAfterZeroing) __syncthreads();
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < count && bug == Bug::kPlainSum) mine[values[i] % 64] += 1;
  if (i < count && bug != Bug::kPlainSum) atomicAdd(&mine[values[i] % 64], 1u);
  if (bug != Bug::kBarrierBeforeReadOut) __syncthreads();
  for (unsigned bin = threadIdx.x; bin < 64; bin += blockDim.x) atomicAdd(&bins[bin], mine[bin]);
}

/// Sums of blocks, by warps first; `kNone` or the barrier between the warps' sums and their use left out.
template <bool barrier>
__global__ void sums_of_warps(const unsigned* values, unsigned* sums) {
  RPTV_SHARED(unsigned, of_warp, [32]);
  unsigned sum = values[blockIdx.x * blockDim.x + threadIdx.x];
  for (int step = 16; step > 0; step /= 2) sum += __shfl_xor_sync(0xffffffffu, sum, step);
  if (threadIdx.x % 32 == 0) of_warp[threadIdx.x / 32] = sum;
  if (barrier) __syncthreads();
  if (threadIdx.x != 0) return;
  unsigned total = 0;
  for (unsigned warp = 0; warp < blockDim.x / 32; ++warp) total += of_warp[warp];
  sums[blockIdx.x] = total;
}

/// Neighbours exchange through shared memory; __syncwarp orders that, a shuffle does not.
template <bool barrier>
__global__ void pass_to_next_lane(unsigned* values) {
  RPTV_SHARED(unsigned, given, [32]);
  given[threadIdx.x] = threadIdx.x;
  if (barrier) __syncwarp();
  if (!barrier) __shfl_sync(0xffffffffu, 0, 0);
  values[threadIdx.x] = given[(threadIdx.x + 1) % 32];
}

template <bool atomic>
__global__ void append(unsigned* list, unsigned* length) {
  const unsigned at = atomic ? atomicAdd(length, 1u) : (*length)++;
  list[at] = threadIdx.x;
}

/// One word of global memory from each block; `shared_word`: the same one.
template <bool shared_word>
__global__ void one_word_a_block(unsigned* words) {
  if (threadIdx.x == 0) words[shared_word ? 0 : blockIdx.x] = 1;
}

/// The last block to finish adds up what the others left: needs fences on both sides of the count.
template <bool fences>
__global__ void last_block_sums(unsigned* of_block, unsigned* finished, unsigned* total) {
  if (threadIdx.x != 0) return;
  of_block[blockIdx.x] = blockIdx.x;
  if (fences) __threadfence();
  if (atomicAdd(finished, 1u) + 1 < gridDim.x) return;
  if (fences) __threadfence();
  for (unsigned block = 0; block < gridDim.x; ++block) *total += of_block[block];
}

template <class... Parameters, class... Arguments>
void run(unsigned blocks, unsigned threads, void (*kernel)(Parameters...), Arguments... arguments) {
  const cudaLaunchConfig_t launch = launch_of(blocks, threads);
  ASSERT_EQ(cudaLaunchKernelEx(&launch, kernel, arguments...), cudaSuccess);
  ASSERT_EQ(cudaDeviceSynchronize(), cudaSuccess) << rptv::cuda_host::last_fault();
}

class Races : public testing::TestWithParam<unsigned> {
 protected:
  void SetUp() override {
    rptv::cuda_host::set_schedule_seed(GetParam());
    testing::FLAGS_gtest_death_test_style = "fast";
  }
  void TearDown() override { rptv::cuda_host::set_schedule_seed(0); }

  const DeviceValues<unsigned> values_{std::vector<unsigned>(1024, 3)};
  const DeviceValues<unsigned> results_{std::vector<unsigned>(2048, 0)};
  const DeviceValues<unsigned> count_{std::vector<unsigned>(1, 0)};
};

#if defined(__SANITIZE_THREAD__)
#define EXPECT_RACE(...) \
  EXPECT_EXIT(           \
      {                  \
        __VA_ARGS__;     \
        std::exit(0);    \
      },                 \
      testing::ExitedWithCode(66), "data race.*")
#else
#define EXPECT_RACE(...) GTEST_SKIP() << "races are reported by the ThreadSanitizer build only (cmake --preset tsan)"
#endif

TEST_P(Races, none_where_all_is_ordered) {
  run(4, 96, histogram<Bug::kNone>, values_.get(), 300, results_.get());
  run(4, 256, sums_of_warps<true>, values_.get(), results_.get());
  run(1, 32, pass_to_next_lane<true>, results_.get());
  run(4, 96, append<true>, results_.get(), count_.get());
  run(40, 96, one_word_a_block<false>, results_.get());
  EXPECT_EQ(count_.read()[0], 4u * 96);
}

TEST_P(Races, none_where_fences_order_blocks) {
  const DeviceValues<unsigned> total(std::vector<unsigned>(1, 0));
  run(40, 32, last_block_sums<true>, results_.get(), count_.get(), total.get());
  EXPECT_EQ(total.read()[0], 40u * 39 / 2);
}

TEST_P(Races, missing_barrier_after_zeroing) {
  EXPECT_RACE(run(4, 96, histogram<Bug::kBarrierAfterZeroing>, values_.get(), 300, results_.get()));
}

TEST_P(Races, missing_barrier_before_read_out) {
  EXPECT_RACE(run(4, 96, histogram<Bug::kBarrierBeforeReadOut>, values_.get(), 300, results_.get()));
}

TEST_P(Races, plain_sum_in_shared_memory) {
  EXPECT_RACE(run(4, 96, histogram<Bug::kPlainSum>, values_.get(), 300, results_.get()));
}

TEST_P(Races, missing_barrier_between_sums_of_warps_and_their_use) {
  EXPECT_RACE(run(4, 256, sums_of_warps<false>, values_.get(), results_.get()));
}

TEST_P(Races, shuffle_taken_for_a_barrier) { EXPECT_RACE(run(1, 32, pass_to_next_lane<false>, results_.get())); }

TEST_P(Races, plain_count_of_an_append) { EXPECT_RACE(run(4, 96, append<false>, results_.get(), count_.get())); }

TEST_P(Races, two_blocks_write_one_word) { EXPECT_RACE(run(2, 96, one_word_a_block<true>, results_.get())); }

TEST_P(Races, missing_fence_before_the_last_block) {
  EXPECT_RACE(run(40, 32, last_block_sums<false>, results_.get(), count_.get(), values_.get()));
}

INSTANTIATE_TEST_SUITE_P(schedules, Races, testing::Values(0u, 5u));

}  // namespace
