// SPDX-License-Identifier: MIT
// The least that every supported device has (compute capability 7.5; CUDA C++ Programming Guide, technical
// specifications).
#pragma once

#include <cstddef>

namespace rptv::cuda_host {

inline constexpr std::size_t kSharedBytes = 48 * 1024;       // a block's, without asking
inline constexpr std::size_t kSharedOptInBytes = 64 * 1024;  // with cudaFuncSetAttribute()
inline constexpr unsigned kMaxThreads = 1024;
inline constexpr unsigned kMaxBlockZ = 64;
inline constexpr unsigned kMaxGridX = 2147483647;
inline constexpr unsigned kMaxGridYz = 65535;
inline constexpr int kMultiprocessors = 36;

// The stand-in's own: no device has them.
inline constexpr int kClockKhz = 1000000;
inline constexpr int kMemoryClockKhz = 2000000;
inline constexpr int kMemoryBusBits = 256;

}  // namespace rptv::cuda_host
