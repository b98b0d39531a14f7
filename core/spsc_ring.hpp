// SPDX-License-Identifier: MIT
// A lock-free queue from exactly one producer thread to exactly one consumer thread.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

namespace rptv {

inline constexpr std::size_t kCacheLineBytes = 64;

/// Capacity is rounded up to a power of two. Both counters count moves since construction in 64 bits: at 10⁹ moves a
/// second they wrap after 584 years, so `written - read` is always the fill and no slot is wasted to tell full from
/// empty. T is default constructible and nothrow movable; a popped cell keeps its moved-from value until it is written
/// again.
template <class T>
class SpscRing {
 public:
  explicit SpscRing(std::size_t capacity)
      : capacity_(capacity < 1 ? 1 : capacity),
        mask_(std::bit_ceil(capacity_) - 1),
        cells_(std::make_unique<T[]>(mask_ + 1)) {}
  SpscRing(const SpscRing&) = delete;
  SpscRing& operator=(const SpscRing&) = delete;

  /// Producer only. False, and `value` untouched, when the ring is full.
  bool try_push(T&& value) noexcept {
    const std::uint64_t written = written_.load(std::memory_order_relaxed);  // own counter: nobody else writes it
    if (written - read_seen_ >= capacity_) {
      // acquire pairs with the consumer's release: it has finished moving out of the cell that we are about to reuse.
      read_seen_ = read_.load(std::memory_order_acquire);
      if (written - read_seen_ >= capacity_) return false;
    }
    cells_[written & mask_] = std::move(value);
    // release: the cell's content is visible to whoever sees the new count.
    written_.store(written + 1, std::memory_order_release);
    return true;
  }

  /// Consumer only. False when the ring is empty.
  bool try_pop(T& value) noexcept {
    const std::uint64_t read = read_.load(std::memory_order_relaxed);  // own counter
    if (read == written_seen_) {
      // acquire pairs with the producer's release: the cells up to the count are filled.
      written_seen_ = written_.load(std::memory_order_acquire);
      if (read == written_seen_) return false;
    }
    value = std::move(cells_[read & mask_]);
    // release: our move out of the cell is done before the producer may see it as free.
    read_.store(read + 1, std::memory_order_release);
    return true;
  }

  /// Any thread; the fill at some moment during the call.
  std::size_t size() const noexcept {
    const std::uint64_t read = read_.load(std::memory_order_acquire);
    const std::uint64_t written = written_.load(std::memory_order_acquire);
    return std::min(static_cast<std::size_t>(written - read), capacity_);  // read may be older than written
  }
  std::size_t capacity() const noexcept { return capacity_; }
  std::uint64_t pushed() const noexcept { return written_.load(std::memory_order_relaxed); }
  std::uint64_t popped() const noexcept { return read_.load(std::memory_order_relaxed); }

 private:
  const std::size_t capacity_;
  const std::size_t mask_;
  const std::unique_ptr<T[]> cells_;
  // The producer's line: its counter and what it last saw of the other's, so that the other line is fetched only when
  // the ring looks full.
  alignas(kCacheLineBytes) std::atomic<std::uint64_t> written_{0};
  std::uint64_t read_seen_ = 0;
  // The consumer's line, likewise.
  alignas(kCacheLineBytes) std::atomic<std::uint64_t> read_{0};
  std::uint64_t written_seen_ = 0;
};

}  // namespace rptv
