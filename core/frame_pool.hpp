// SPDX-License-Identifier: MIT
// All memory that frames will ever use, taken once at start, and the leases through which it is used.
#pragma once

#include <cstddef>
#include <span>

#include "core/lease.hpp"
#include "core/slot_book.hpp"
#include "core/wake.hpp"

namespace rptv {

/// `slots` buffers of `bytes_per_slot` each, page aligned, touched at construction so that no page fault comes later.
/// claim() and the drop of a lease: any thread, lock-free, no allocation. Construction and destruction: one thread.
class FramePool {
 public:
  static constexpr std::size_t kAlignmentBytes = 4096;

  /// Throws Error: `configuration` for no slots or no bytes, `unavailable` when the machine has not that much memory.
  FramePool(std::size_t slots, std::size_t bytes_per_slot);
  ~FramePool();
  FramePool(const FramePool&) = delete;
  FramePool& operator=(const FramePool&) = delete;

  /// An empty lease when every slot is out: the caller counts the loss.
  Lease<FramePool> claim() noexcept;
  /// Sleeps until a slot may have come back, or the time is over. `seen` is from
  /// prepare_to_wait() before the claim that failed. For policies that wait instead of losing.
  void wait_for_slot(std::uint32_t seen, std::int64_t timeout_ns) noexcept { returned_.wait(seen, timeout_ns); }
  std::uint32_t prepare_to_wait() const noexcept { return returned_.prepare(); }
  /// Ends every wait_for_slot() under way, for shutting down.
  void wake_waiters() noexcept { returned_.notify(); }

  std::size_t slots() const noexcept { return book_.slots(); }
  std::size_t free_slots() const noexcept { return book_.free_slots(); }
  std::size_t bytes_per_slot() const noexcept { return bytes_per_slot_; }
  /// Of all slots: for what must know the memory beforehand.
  std::span<std::byte> memory() noexcept { return {memory_, slots() * stride_}; }

  // The side of the pool that Lease uses.
  std::byte* element(std::size_t slot) noexcept { return memory_ + slot * stride_; }
  void share(std::size_t slot) noexcept { book_.share(slot); }
  void drop(std::size_t slot) noexcept {
    if (book_.drop(slot)) returned_.notify();
  }

 private:
  SlotBook book_;
  std::size_t bytes_per_slot_;
  std::size_t stride_;
  std::byte* memory_;
  Wake returned_;
};

using FrameLease = Lease<FramePool>;

}  // namespace rptv
