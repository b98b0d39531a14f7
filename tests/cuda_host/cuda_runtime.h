// SPDX-License-Identifier: MIT
// Stands in for NVIDIA's <cuda_runtime.h> where tests run the kernels of *_cuda.cu on the CPU: the part of CUDA that
// this project uses.
#pragma once

#define RPTV_CUDA_HOST 1

#include "tests/cuda_host/atomics.hpp"
#include "tests/cuda_host/barriers.hpp"
#include "tests/cuda_host/control.hpp"
#include "tests/cuda_host/device_api.hpp"
#include "tests/cuda_host/error_codes.hpp"
#include "tests/cuda_host/graph_api.hpp"
#include "tests/cuda_host/intrinsics.hpp"
#include "tests/cuda_host/kernel_language.hpp"
#include "tests/cuda_host/launch.hpp"
#include "tests/cuda_host/memory_api.hpp"
#include "tests/cuda_host/shared_memory.hpp"
#include "tests/cuda_host/stream_api.hpp"
#include "tests/cuda_host/vector_types.hpp"
#include "tests/cuda_host/warp.hpp"
