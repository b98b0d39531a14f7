// SPDX-License-Identifier: MIT
// Shuffles and votes among the lanes of a warp. As on the device they order no memory: that takes __syncwarp().
#pragma once

#include <cstring>
#include <type_traits>

#include "tests/cuda_host/collective.hpp"

namespace rptv::cuda_host {

template <class T>
T exchange(unsigned mask, T value, unsigned source_lane, Site site) {
  static_assert(sizeof(T) <= 8 && std::is_arithmetic_v<T>, "shuffles move numbers of up to 8 bytes");
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof(T));
  bits = meet(Meeting::kExchange, mask, bits, source_lane, site);
  std::memcpy(&value, &bits, sizeof(T));
  return value;
}

/// The lane's group of `width` lanes begins here.
inline unsigned group_begin(int width) { return lane() & ~(static_cast<unsigned>(width) - 1); }

inline unsigned ballot(unsigned mask, int predicate, Site site) {
  return static_cast<unsigned>(meet(Meeting::kBallot, mask, predicate != 0, 0, site));
}

}  // namespace rptv::cuda_host

template <class T>
T __shfl_sync(unsigned mask, T value, int source_lane, int width = 32, const char* file = __builtin_FILE(),
              int line = __builtin_LINE()) {
  using namespace rptv::cuda_host;
  const unsigned source =
      group_begin(width) + (static_cast<unsigned>(source_lane) & (static_cast<unsigned>(width) - 1));
  return exchange(mask, value, source, {file, line});
}

template <class T>
T __shfl_up_sync(unsigned mask, T value, unsigned delta, int width = 32, const char* file = __builtin_FILE(),
                 int line = __builtin_LINE()) {
  using namespace rptv::cuda_host;
  const bool inside = lane() >= group_begin(width) + delta;
  return exchange(mask, value, inside ? lane() - delta : lane(), {file, line});
}

template <class T>
T __shfl_down_sync(unsigned mask, T value, unsigned delta, int width = 32, const char* file = __builtin_FILE(),
                   int line = __builtin_LINE()) {
  using namespace rptv::cuda_host;
  const bool inside = lane() + delta < group_begin(width) + static_cast<unsigned>(width);
  return exchange(mask, value, inside ? lane() + delta : lane(), {file, line});
}

template <class T>
T __shfl_xor_sync(unsigned mask, T value, int lane_mask, int width = 32, const char* file = __builtin_FILE(),
                  int line = __builtin_LINE()) {
  using namespace rptv::cuda_host;
  const unsigned source = lane() ^ static_cast<unsigned>(lane_mask);
  const bool inside = source < group_begin(width) + static_cast<unsigned>(width);
  return exchange(mask, value, inside ? source : lane(), {file, line});
}

inline unsigned __ballot_sync(unsigned mask, int predicate, const char* file = __builtin_FILE(),
                              int line = __builtin_LINE()) {
  return rptv::cuda_host::ballot(mask, predicate, {file, line});
}

inline int __any_sync(unsigned mask, int predicate, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  return rptv::cuda_host::ballot(mask, predicate, {file, line}) != 0;
}

inline int __all_sync(unsigned mask, int predicate, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  return rptv::cuda_host::ballot(mask, predicate == 0, {file, line}) == 0;
}
