// SPDX-License-Identifier: MIT
// CUDA's qualifiers, which mean nothing to a host compiler, and the variables that tell a thread where it stands.
#pragma once

#include "tests/cuda_host/vector_types.hpp"

#define __global__
#define __device__
#define __host__
#define __constant__
#define __forceinline__ inline __attribute__((always_inline))
#define __launch_bounds__(...)
#define __align__(bytes) __attribute__((aligned(bytes)))

// One kernel runs at a time, and the executor sets these before it continues a thread.
extern uint3 threadIdx;
extern uint3 blockIdx;
extern dim3 blockDim;
extern dim3 gridDim;
inline constexpr int warpSize = 32;
