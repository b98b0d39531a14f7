// SPDX-License-Identifier: MIT
// Tuples of views as they lie on the device: what the kernels of matching hand to each other.
#pragma once

#include <cstdint>

namespace rptv {

inline constexpr std::uint32_t kCudaMaxViews = 16;          ///< kMaxViews
inline constexpr std::uint32_t kNoDetection = 0xFFFFFFFFU;  ///< kUnseen

/// All pointers are the device's. `count` may be beyond `capacity`: that many were found, and the last ones had no
/// room.
struct CudaTuples {
  std::uint32_t* detection;  ///< of view v in tuple i: detection[v·capacity + i], or kNoDetection
  std::uint32_t* count;
  std::uint32_t capacity, views;
};

/// Where each tuple's rays meet: eq. (4)'s point, in the unit of its columns, and A's smallest singular value.
struct CudaPoints {
  double *x, *y, *z, *s;  ///< capacity of the tuples each
};

/// What a frame set was too much for, and how many rays were followed, pairs lie near them. On the device; the caller
/// zeroes it.
struct CudaMatchCounts {
  unsigned long long refused_hits;    ///< detections near one place beyond the first eight
  unsigned long long refused_pairs;   ///< beyond the room for pairs
  unsigned long long refused_tuples;  ///< beyond the room for tuples, or kMostOfAPair of one pair
  unsigned long long rays, pairs;     ///< as CorrespondenceCounts
};

}  // namespace rptv
