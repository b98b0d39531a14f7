// SPDX-License-Identifier: MIT
// Correct kernels for tests of the executor; compiled by g++ and, where there is nvcc, to PTX that the interpreter
// runs.
#pragma once

#include "reconstruct/cuda_device.hpp"
#include "tests/cuda_host/sample_arithmetic.hpp"

namespace rptv::cuda_host::sample {

/// What a value has in set bits, leading zeros, and its lowest bit; votes of the block and of the warp.
__global__ void bits_and_votes(const unsigned* values, unsigned count, int* set, int* zeros, int* lowest, int* votes) {
  const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
  const unsigned value = i < count ? values[i] : 0u;
  const int odd_in_block = __syncthreads_count(static_cast<int>(value & 1u));
  const int some = __any_sync(0xffffffffu, value > 1000000u);
  const int every = __all_sync(0xffffffffu, value > 5u);
  const unsigned next = __shfl_down_sync(0xffffffffu, value, 1, 16);
  if (i >= count) return;
  set[i] = __popc(value);
  zeros[i] = __clz(static_cast<int>(value));
  lowest[i] = __ffs(static_cast<int>(value));
  votes[i] = odd_in_block + 10000 * some + 20000 * every + 40000 * (next > value ? 1 : 0);
}

/// The greatest value and, of the places where it stands, the first; by atomics of 32 and 64 bits.
__global__ void greatest(const unsigned* values, unsigned count, unsigned* value, unsigned long long* packed) {
  const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= count) return;
  atomicMax(value, values[i]);
  atomicMax(packed, static_cast<unsigned long long>(values[i]) << 32 | (0xffffffffu - i));
}

/// Writes past the end of a shared array where `count` is greater than 64.
__global__ void fill_shared(unsigned count, unsigned* sums) {
  RPTV_SHARED(unsigned, values, [64]);
  for (unsigned i = threadIdx.x; i < count; i += blockDim.x) values[i] = i;
  __syncthreads();
  if (threadIdx.x < 64) sums[threadIdx.x] = values[63 - threadIdx.x];
}

/// A barrier that half of the block does not come to where `all` is 0.
__global__ void meet_or_not(int all, unsigned* seen) {
  if (all != 0 || threadIdx.x < blockDim.x / 2) __syncthreads();
  seen[threadIdx.x] = 1;
}

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

}  // namespace rptv::cuda_host::sample
