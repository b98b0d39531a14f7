// SPDX-License-Identifier: MIT
// What every CUDA source includes instead of <cuda_runtime.h>: shared memory in a form that a host compiler can parse,
// too. Kernels are launched by cudaLaunchKernelEx() only, which is a function, so that the tests run the same sources
// on the CPU against tests/cuda_host/cuda_runtime.h, which then stands first on the include path and defines these
// macros its own way.
#pragma once

#include <cuda_runtime.h>

#if !defined(RPTV_CUDA_HOST)
/// RPTV_SHARED(int, sums, [32]): an array of the block, `int sums[32]`.
#define RPTV_SHARED(type, name, ...) __shared__ type name __VA_ARGS__
/// `type* name`: the block's dynamic shared memory; at most one in a kernel.
#define RPTV_DYNAMIC_SHARED(type, name)                                \
  extern __shared__ __align__(16) unsigned char rptv_dynamic_shared[]; \
  type* const name = reinterpret_cast<type*>(rptv_dynamic_shared)
#endif
