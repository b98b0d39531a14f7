// SPDX-License-Identifier: MIT
// Barriers and fences of CUDA; each knows the line that it was called from.
#pragma once

#include "tests/cuda_host/collective.hpp"
#include "tests/cuda_host/kernel_language.hpp"

inline int __syncthreads_count(int predicate, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  using namespace rptv::cuda_host;
  return static_cast<int>(meet(Meeting::kBlock, 0, predicate != 0, 0, {file, line}));
}

inline void __syncthreads(const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  __syncthreads_count(0, file, line);
}

inline int __syncthreads_or(int predicate, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  return __syncthreads_count(predicate, file, line) > 0;
}

inline int __syncthreads_and(int predicate, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  const unsigned threads = blockDim.x * blockDim.y * blockDim.z;
  return static_cast<unsigned>(__syncthreads_count(predicate, file, line)) == threads;
}

inline void __syncwarp(unsigned mask = 0xffffffffu, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  using namespace rptv::cuda_host;
  meet(Meeting::kWarp, mask, 0, 0, {file, line});
}

inline void __threadfence() { rptv::cuda_host::fence(); }
inline void __threadfence_block() { rptv::cuda_host::fence(); }
inline void __threadfence_system() { rptv::cuda_host::fence(); }

[[noreturn]] inline void __trap(const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  rptv::cuda_host::kernel_fault("__trap()", {file, line});
}
