// SPDX-License-Identifier: MIT
// The system calls that a V4L2 device is used through, as a seam for tests.
#pragma once

#include <poll.h>

#include <cstddef>

namespace rptv {

/// Each is the system call of its name, errno included. The base class calls the system. Any thread.
class V4l2System {
 public:
  virtual ~V4l2System() = default;
  virtual int open(const char* path) noexcept;  ///< for reading and writing, non-blocking
  virtual int close(int descriptor) noexcept;
  virtual int ioctl(int descriptor, unsigned long request, void* argument) noexcept;
  virtual void* mmap(int descriptor, std::size_t bytes, long offset) noexcept;  ///< shared, readable; MAP_FAILED
  virtual int munmap(void* memory, std::size_t bytes) noexcept;
  virtual int poll(pollfd* descriptors, unsigned long count, int timeout_ms) noexcept;
  /// ioctl, again while signals interrupt it.
  int call(int descriptor, unsigned long request, void* argument) noexcept;
};

}  // namespace rptv
