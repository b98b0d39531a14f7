// SPDX-License-Identifier: MIT
// Streams and events with owners, for code that knows no CUDA header.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace rptv {

/// What the CUDA runtime last refused in this thread, as "name: text", which is then forgotten; empty: nothing.
std::string take_cuda_error();

enum class CudaStage : std::uint8_t;  // reconstruct/cuda_stage_timer.hpp
class StageMarks;

/// Work in order. One host thread at a time. Each call is false when the runtime refuses, or when earlier work failed.
/// A stream that is made where a StageTimer lives is watched by it; others have nothing to do with one.
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

  /// Work queued from here on is this stage's; true, so that it can stand in a chain of calls.
  bool stage(CudaStage stage) noexcept {
    if (marks_ != nullptr) mark(stage);
    return true;
  }
  /// What the kernels of a stage did at least: bytes of device memory read and written, atomic increments.
  void tell(CudaStage stage, std::size_t bytes, std::uint64_t increments = 0) noexcept {
    if (marks_ != nullptr) add(stage, bytes, increments);
  }
  bool watched() const noexcept { return marks_ != nullptr; }
  bool timed() const noexcept;  ///< watched, and recorded now

 private:
  void mark(CudaStage stage) noexcept;
  void add(CudaStage stage, std::size_t bytes, std::uint64_t increments) noexcept;
  void count_copy(std::size_t bytes) noexcept;

  void* handle_ = nullptr;
  std::shared_ptr<StageMarks> marks_;  // null in production
};

/// A place in a stream's work.
class CudaEvent {
 public:
  enum class Use { order, time };

  explicit CudaEvent(Use use = Use::order);  ///< throws Error(unavailable)
  ~CudaEvent();
  CudaEvent(const CudaEvent&) = delete;
  CudaEvent& operator=(const CudaEvent&) = delete;

  void* handle() const noexcept { return handle_; }  ///< a cudaEvent_t
  bool record(const CudaStream& stream) noexcept;
  bool synchronize() noexcept;  ///< the host waits
  /// Device time from here to `end`, both made to time, recorded and passed; false where they are not.
  bool time_to(const CudaEvent& end, float& elapsed_ms) const noexcept;

 private:
  void* handle_ = nullptr;
};

}  // namespace rptv
