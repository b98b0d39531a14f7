// SPDX-License-Identifier: MIT
// Values on the executor's device for tests, and the schedules that a kernel's result must not depend on.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "reconstruct/cuda_memory.hpp"
#include "tests/cuda_host/control.hpp"

namespace rptv::testing {

/// A vector's copy on the device.
template <class T>
class OnDevice {
 public:
  explicit OnDevice(const std::vector<T>& values) : array_(values.size()) {
    CudaStream stream;
    EXPECT_TRUE(stream.upload(array_.data(), values.data(), values.size() * sizeof(T)) && stream.synchronize());
  }
  T* data() const { return array_.data(); }
  /// What is there when `stream` is done.
  std::vector<T> read(CudaStream& stream) const {
    std::vector<T> values(array_.size());
    EXPECT_TRUE(stream.download(values.data(), array_.data(), values.size() * sizeof(T)) && stream.synchronize())
        << take_cuda_error() << ": " << cuda_host::last_fault();
    return values;
  }

 private:
  DeviceArray<T> array_;
};

/// run(threads per block) for several sizes of blocks and orders of threads.
template <class Run>
void with_every_schedule(const Run& run) {
  for (const std::uint64_t seed : {0U, 1U, 5U})
    for (const unsigned threads : {32U, 96U, 256U}) {
      SCOPED_TRACE(::testing::Message() << "blocks of " << threads << " threads, schedule " << seed);
      cuda_host::set_schedule_seed(seed);
      run(threads);
      EXPECT_EQ(cuda_host::last_fault(), "");
    }
  cuda_host::set_schedule_seed(0);
}

}  // namespace rptv::testing
