// SPDX-License-Identifier: MIT
// Allocation of the frame memory and its first touch.
#include "core/frame_pool.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <string>

#include "core/error.hpp"

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
  // Large pages where there are any: an image of some MB lies on hundreds of small ones, and each costs a look-up.
  constexpr std::size_t kLargePage = 2 << 20;
  const std::size_t alignment = slots * stride < kLargePage ? FramePool::kAlignmentBytes : kLargePage;
  const std::size_t bytes = (slots * stride + alignment - 1) / alignment * alignment;
  if (stride != 0 && slots <= memory_bytes / stride) memory = std::aligned_alloc(alignment, bytes);
  if (memory != nullptr && alignment == kLargePage) madvise(memory, bytes, MADV_HUGEPAGE);
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
