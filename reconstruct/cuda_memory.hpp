// SPDX-License-Identifier: MIT
// Device memory, page-locked host memory, streams and events with owners, for code that knows no CUDA header.
#pragma once

#include <cstddef>
#include <string>
#include <utility>

namespace rptv {

/// What the CUDA runtime last refused in this thread, as "name: text", which is then forgotten; empty: nothing.
std::string take_cuda_error();

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

/// Work in order. One host thread at a time. Each call is false when the runtime refuses, or when earlier work failed.
class CudaStream {
 public:
  CudaStream();  ///< throws Error(unavailable)
  ~CudaStream();
  CudaStream(const CudaStream&) = delete;
  CudaStream& operator=(const CudaStream&) = delete;

  void* handle() const noexcept { return handle_; }  ///< a cudaStream_t
  /// Host memory is read, and written, when the stream gets there: it must be pinned, and left alone until then.
  bool upload(void* device, const void* host, std::size_t bytes) noexcept;
  bool download(void* host, const void* device, std::size_t bytes) noexcept;
  bool fill(void* device, unsigned char byte, std::size_t bytes) noexcept;
  bool wait_for(const class CudaEvent& event) noexcept;  ///< later work waits; the host does not
  bool synchronize() noexcept;

 private:
  void* handle_ = nullptr;
};

/// A place in a stream's work.
class CudaEvent {
 public:
  CudaEvent();  ///< throws Error(unavailable)
  ~CudaEvent();
  CudaEvent(const CudaEvent&) = delete;
  CudaEvent& operator=(const CudaEvent&) = delete;

  void* handle() const noexcept { return handle_; }  ///< a cudaEvent_t
  bool record(const CudaStream& stream) noexcept;
  bool synchronize() noexcept;  ///< the host waits

 private:
  void* handle_ = nullptr;
};

}  // namespace rptv
