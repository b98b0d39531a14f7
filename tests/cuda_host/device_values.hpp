// SPDX-License-Identifier: MIT
// Device memory with values in it, for tests; read() waits for the null stream.
#pragma once

#include <cuda_runtime.h>

#include <vector>

namespace rptv::cuda_host {

template <class T>
class DeviceValues {
 public:
  explicit DeviceValues(const std::vector<T>& values) : count_(values.size()) {
    cudaMalloc(&memory_, count_ * sizeof(T));
    cudaMemcpy(memory_, values.data(), count_ * sizeof(T), cudaMemcpyHostToDevice);
  }
  ~DeviceValues() { cudaFree(memory_); }
  DeviceValues(const DeviceValues&) = delete;
  DeviceValues& operator=(const DeviceValues&) = delete;

  T* get() const { return memory_; }
  std::size_t size() const { return count_; }

  std::vector<T> read() const {
    std::vector<T> values(count_);
    cudaMemcpy(values.data(), memory_, count_ * sizeof(T), cudaMemcpyDeviceToHost);
    return values;
  }

 private:
  T* memory_ = nullptr;
  std::size_t count_;
};

}  // namespace rptv::cuda_host
