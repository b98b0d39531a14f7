// SPDX-License-Identifier: MIT
// Which slots of a pool are free and how many leases each busy one has: a lock-free bitmap and counters.
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace rptv {

/// Claim, share and drop may be called by any thread at any time; none allocates, locks or fails otherwise than stated.
class SlotBook {
 public:
  static constexpr std::size_t kNone = SIZE_MAX;

  explicit SlotBook(std::size_t slots)
      : slots_(slots),
        words_((slots + 63) / 64),
        free_(std::make_unique<std::atomic<std::uint64_t>[]>(words_)),
        leases_(std::make_unique<std::atomic<std::uint32_t>[]>(slots)) {
    for (std::size_t i = 0; i < slots; ++i) free_[i / 64].fetch_or(std::uint64_t{1} << (i % 64));
  }

  std::size_t slots() const noexcept { return slots_; }

  /// Takes a free slot with one lease on it; kNone when all are out.
  std::size_t claim() noexcept {
    for (std::size_t w = 0; w < words_; ++w) {
      std::uint64_t bits = free_[w].load(std::memory_order_relaxed);
      while (bits != 0) {
        const std::uint64_t lowest = bits & (~bits + 1);
        // acquire: everything the last holder did to the slot happens before our use of it.
        if (free_[w].compare_exchange_weak(bits, bits & ~lowest, std::memory_order_acquire,
                                           std::memory_order_relaxed)) {
          const std::size_t slot = w * 64 + static_cast<std::size_t>(std::countr_zero(lowest));
          leases_[slot].store(1, std::memory_order_relaxed);
          return slot;
        }
      }
    }
    return kNone;
  }

  /// One more lease on a slot that the caller holds a lease on.
  void share(std::size_t slot) noexcept { leases_[slot].fetch_add(1, std::memory_order_relaxed); }

  /// Gives one lease back; returns true when it was the last and the slot is free again.
  bool drop(std::size_t slot) noexcept {
    // acq_rel: the last dropper must have seen every other holder's accesses before it frees the slot.
    if (leases_[slot].fetch_sub(1, std::memory_order_acq_rel) != 1) return false;
    free_[slot / 64].fetch_or(std::uint64_t{1} << (slot % 64), std::memory_order_release);
    return true;
  }

  /// Free slots at some moment during the call.
  std::size_t free_slots() const noexcept {
    std::size_t n = 0;
    for (std::size_t w = 0; w < words_; ++w)
      n += static_cast<std::size_t>(std::popcount(free_[w].load(std::memory_order_relaxed)));
    return n;
  }

 private:
  std::size_t slots_;
  std::size_t words_;
  std::unique_ptr<std::atomic<std::uint64_t>[]> free_;
  std::unique_ptr<std::atomic<std::uint32_t>[]> leases_;
};

}  // namespace rptv
