// SPDX-License-Identifier: MIT
// Memory of somebody else that stays where it is while this lives, so that a device reads it without a further copy.
#pragma once

#include <cstddef>
#include <utility>

namespace rptv {

/// Set-up only: locking is a system call over all pages. Memory must outlive it, and work on it be done when it goes.
class CudaPageLock {
 public:
  CudaPageLock(void* memory, std::size_t bytes) noexcept;
  ~CudaPageLock();
  CudaPageLock(CudaPageLock&& other) noexcept : memory_(std::exchange(other.memory_, nullptr)) {}
  CudaPageLock& operator=(CudaPageLock&&) = delete;

  /// False when the system refuses; copies work as before, only slower.
  bool locked() const noexcept { return memory_ != nullptr; }

 private:
  void* memory_;
};

}  // namespace rptv
