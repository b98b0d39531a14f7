// SPDX-License-Identifier: MIT
// Device memory with values in it, for tests; read() waits for the null stream.
#pragma once

#include <cuda_runtime.h>

#include <vector>

namespace rptv {

template <class T>
class DeviceArray {
 public:
  explicit DeviceArray(const std::vector<T>& values) : count_(values.size()) {
    cudaMalloc(&memory_, count_ * sizeof(T));
    cudaMemcpy(memory_, values.data(), count_ * sizeof(T), cudaMemcpyHostToDevice);
  }
  ~DeviceArray() { cudaFree(memory_); }
  DeviceArray(const DeviceArray&) = delete;
  DeviceArray& operator=(const DeviceArray&) = delete;

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

}  // namespace rptv
