// SPDX-License-Identifier: MIT
// Allocation of the frame memory and its first touch.
#include "core/frame_pool.hpp"

#include <cstdlib>
#include <cstring>
#include <string>

#include "core/error.hpp"

namespace rptv {

FramePool::FramePool(std::size_t slots, std::size_t bytes_per_slot)
    : book_(slots),
      bytes_per_slot_(bytes_per_slot),
      stride_((bytes_per_slot + kAlignmentBytes - 1) / kAlignmentBytes * kAlignmentBytes),
      memory_(static_cast<std::byte*>(std::aligned_alloc(kAlignmentBytes, slots * stride_))) {
  if (memory_ == nullptr)
    throw Error(ExitCode::unavailable, "no memory for " + std::to_string(slots) + " frames of " +
                                           std::to_string(bytes_per_slot) + " bytes; lower 'pool_frames'");
  std::memset(memory_, 0, slots * stride_);
}

FramePool::~FramePool() { std::free(memory_); }

Lease<FramePool> FramePool::claim() noexcept {
  const std::size_t slot = book_.claim();
  return slot == SlotBook::kNone ? Lease<FramePool>() : Lease<FramePool>(this, slot);
}

}  // namespace rptv
