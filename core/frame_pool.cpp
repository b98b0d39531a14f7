// SPDX-License-Identifier: MIT
// Allocation of the frame memory and its first touch.
#include "core/frame_pool.hpp"

#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <string>

#include "core/error.hpp"
#include "core/huge_pages.hpp"

namespace rptv {

namespace {

std::size_t stride_of(std::size_t bytes_per_slot) {
  constexpr std::size_t kAlign = FramePool::kAlignmentBytes;
  return (bytes_per_slot + kAlign - 1) / kAlign * kAlign;
}

// Linux hands out more memory than there is and kills the process on first touch: ask before.
std::byte* allocate(std::size_t slots, std::size_t bytes_per_slot) {
  const std::string size = std::to_string(slots) + " frames of " + std::to_string(bytes_per_slot) + " bytes";
  if (slots == 0 || bytes_per_slot == 0)
    throw Error(ExitCode::configuration, "a frame pool of " + size + " is empty; set pool_frames and the image size");
  const std::size_t stride = stride_of(bytes_per_slot);
  const auto memory_bytes =
      static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  void* memory = nullptr;
  if (stride != 0 && slots <= memory_bytes / stride)
    memory = allocate_in_huge_pages(slots * stride, FramePool::kAlignmentBytes);
  if (memory == nullptr)
    throw Error(ExitCode::unavailable, "no memory for " + size + " (this machine has " +
                                           std::to_string(memory_bytes >> 20) + " MiB); lower pool_frames");
  return static_cast<std::byte*>(memory);
}

}  // namespace

FramePool::FramePool(std::size_t slots, std::size_t bytes_per_slot)
    : book_(slots),
      bytes_per_slot_(bytes_per_slot),
      stride_(stride_of(bytes_per_slot)),
      memory_(allocate(slots, bytes_per_slot)) {
  std::memset(memory_, 0, slots * stride_);
}

FramePool::~FramePool() { std::free(memory_); }

Lease<FramePool> FramePool::claim() noexcept {
  const std::size_t slot = book_.claim();
  return slot == SlotBook::kNone ? Lease<FramePool>() : Lease<FramePool>(this, slot);
}

}  // namespace rptv
