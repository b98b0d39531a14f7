// SPDX-License-Identifier: MIT
// The real system calls.
#include "acquisition/v4l2_system.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>

namespace rptv {

int V4l2System::open(const char* path) noexcept { return ::open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC); }
int V4l2System::close(int descriptor) noexcept { return ::close(descriptor); }
int V4l2System::ioctl(int descriptor, unsigned long request, void* argument) noexcept {
  return ::ioctl(descriptor, request, argument);
}
void* V4l2System::mmap(int descriptor, std::size_t bytes, long offset) noexcept {
  return ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, descriptor, offset);
}
int V4l2System::munmap(void* memory, std::size_t bytes) noexcept { return ::munmap(memory, bytes); }
int V4l2System::poll(pollfd* descriptors, unsigned long count, int timeout_ms) noexcept {
  return ::poll(descriptors, count, timeout_ms);
}
int V4l2System::call(int descriptor, unsigned long request, void* argument) noexcept {
  int result = 0;
  do result = ioctl(descriptor, request, argument);
  while (result < 0 && errno == EINTR);
  return result;
}

}  // namespace rptv
