// SPDX-License-Identifier: MIT
// Marks arithmetic that stands once and is compiled for the CPU and for CUDA.
#pragma once

#if defined(__CUDACC__)
#define RPTV_HOST_DEVICE __host__ __device__
#else
#define RPTV_HOST_DEVICE
#endif

/// The same for what must end up inside the loops that call it, so that they become vector code.
#define RPTV_HOST_DEVICE_INLINE [[gnu::always_inline]] RPTV_HOST_DEVICE inline
