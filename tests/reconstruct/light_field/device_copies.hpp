// SPDX-License-Identifier: MIT
// Values to the device and back, for tests of kernels, and the block sizes and schedules that they run in.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "reconstruct/cuda_memory.hpp"
#include "tests/cuda_host/control.hpp"

namespace rptv::testing {

#if defined(__SANITIZE_THREAD__)
inline constexpr bool kWatchesRaces = true;  // slow: small cases show as much
#else
inline constexpr bool kWatchesRaces = false;
#endif

inline constexpr unsigned kBlockSizes[] = {32, 96, 256};
inline constexpr std::uint64_t kSchedules[] = {0, 1, 5};

template <class T>
DeviceArray<T> on_device(CudaStream& stream, const std::vector<T>& values) {
  DeviceArray<T> array(values.size());
  EXPECT_TRUE(stream.upload(array.data(), values.data(), values.size() * sizeof(T)) && stream.synchronize());
  return array;
}

template <class T>
std::vector<T> from_device(CudaStream& stream, const DeviceArray<T>& array, std::size_t size) {
  std::vector<T> values(size);
  EXPECT_TRUE(stream.download(values.data(), array.data(), size * sizeof(T)) && stream.synchronize())
      << cuda_host::last_fault();
  return values;
}

template <class T>
std::vector<T> from_device(CudaStream& stream, const DeviceArray<T>& array) {
  return from_device(stream, array, array.size());
}

}  // namespace rptv::testing
