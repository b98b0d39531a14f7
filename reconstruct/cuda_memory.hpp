// SPDX-License-Identifier: MIT
// Device memory and page-locked host memory with owners, for code that knows no CUDA header.
#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "reconstruct/cuda_stream.hpp"

namespace rptv {

/// Bytes on the device that is current, or page-locked ones of the host. The constructor throws Error(unavailable) with
/// the runtime's words when there are not so many; contents are undefined. Whoever queued work on them waits before
/// they go.
class CudaBytes {
 public:
  enum class Place { device, pinned_host };

  CudaBytes() = default;
  CudaBytes(Place place, std::size_t bytes);
  ~CudaBytes();
  CudaBytes(CudaBytes&& other) noexcept : place_(other.place_), data_(std::exchange(other.data_, nullptr)) {}
  CudaBytes& operator=(CudaBytes&& other) noexcept {
    std::swap(place_, other.place_), std::swap(data_, other.data_);
    return *this;
  }
  void* data() const noexcept { return data_; }

 private:
  Place place_ = Place::device;
  void* data_ = nullptr;
};

/// Elements on the device, for kernels' arguments and copies only.
template <class T>
class DeviceArray {
 public:
  explicit DeviceArray(std::size_t size = 0) : bytes_(CudaBytes::Place::device, size * sizeof(T)), size_(size) {}
  T* data() const noexcept { return static_cast<T*>(bytes_.data()); }
  std::size_t size() const noexcept { return size_; }

 private:
  CudaBytes bytes_;
  std::size_t size_ = 0;
};

/// Page-locked elements of the host: what the device reads and writes while the host goes on.
template <class T>
class PinnedArray {
 public:
  explicit PinnedArray(std::size_t size = 0) : bytes_(CudaBytes::Place::pinned_host, size * sizeof(T)), size_(size) {}
  T* data() const noexcept { return static_cast<T*>(bytes_.data()); }
  T& operator[](std::size_t i) const noexcept { return data()[i]; }
  std::size_t size() const noexcept { return size_; }

 private:
  CudaBytes bytes_;
  std::size_t size_ = 0;
};

}  // namespace rptv
