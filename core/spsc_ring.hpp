// SPDX-License-Identifier: MIT
// A lock-free queue from exactly one producer thread to exactly one consumer thread.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>

namespace rptv {

inline constexpr std::size_t kCacheLineBytes = 64;
/// Processors prefetch lines in pairs: what two threads write lies two lines apart.
inline constexpr std::size_t kSeparationBytes = 2 * kCacheLineBytes;

/// Why it is fast. The time of a hand-over is the time in which cache lines change cores. In the usual ring that is two
/// lines, one after the other: the producer's counter, which says that there is something, then the cell. Here each
/// cell carries the number of the move that filled it, beside the value: the consumer reads one line and has both. The
/// producer needs the consumer's counter only when the ring looks full, and remembers what it saw.
///
/// Why it is right. Both counters count moves since construction in 64 bits; at 10⁹ moves a second they wrap after 584
/// years, so no stamp ever comes twice, `written - read` is always the fill, and no cell is wasted to tell full from
/// empty. Three pairs of release and acquire carry everything, named where they stand.
///
/// T is default constructible and nothrow movable, and a moved-from T holds no resource (a lease does not): a popped
/// cell keeps its moved-from value until it is written again. All memory is taken by the constructor.
template <class T>
class SpscRing {
  static_assert(std::is_nothrow_move_assignable_v<T> && std::is_default_constructible_v<T>);

 public:
  /// Holds exactly `capacity` values, at least 1.
  explicit SpscRing(std::size_t capacity)
      : capacity_(std::max<std::size_t>(capacity, 1)),
        mask_(std::bit_ceil(capacity_) - 1),
        cells_(std::make_unique<Cell[]>(mask_ + 1)) {}
  SpscRing(const SpscRing&) = delete;
  SpscRing& operator=(const SpscRing&) = delete;

  /// Producer only. False, and `value` untouched, when the ring is full.
  bool try_push(T&& value) noexcept {
    const std::uint64_t written = written_.load(std::memory_order_relaxed);  // own counter: nobody else writes it
    if (written - read_seen_ >= capacity_) {
      // acquire, pairs with (b): the consumer has finished moving out of the cell that we are about to reuse.
      read_seen_ = read_.load(std::memory_order_acquire);
      if (written - read_seen_ >= capacity_) return false;
    }
    // Before the stamp, so that whoever sees the consumer's count of this value also sees ours: size() is never
    // negative. Before the value too, so that nothing stands between the stores of value and stamp: a consumer that
    // waits for the stamp may take the line away between them.
    written_.store(written + 1, std::memory_order_relaxed);
    Cell& cell = cells_[written & mask_];
    cell.value = std::move(value);
    cell.stamp.store(written + 1, std::memory_order_release);  // (a) the value is there for whoever sees the stamp
    return true;
  }

  /// Consumer only. False when the ring is empty.
  bool try_pop(T& value) noexcept {
    const std::uint64_t read = read_.load(std::memory_order_relaxed);  // own counter
    Cell& cell = cells_[read & mask_];
    // acquire, pairs with (a). An older stamp means: not filled yet in this lap.
    if (cell.stamp.load(std::memory_order_acquire) != read + 1) return false;
    value = std::move(cell.value);
    read_.store(read + 1, std::memory_order_release);  // (b) we are out of the cell before the producer may reuse it
    return true;
  }

  /// Any thread. Never too small for the producer, and exact while both rest; a value that is just being pushed may
  /// count before try_pop() finds it. Between 0 and capacity() for everybody.
  std::size_t size() const noexcept {
    const std::uint64_t read = read_.load(std::memory_order_acquire);  // pairs with (b), then (a): written_ >= read
    const std::uint64_t written = written_.load(std::memory_order_relaxed);
    return std::min(static_cast<std::size_t>(written - read), capacity_);
  }
  std::size_t capacity() const noexcept { return capacity_; }
  /// Any thread: values pushed and popped since construction.
  std::uint64_t pushed() const noexcept { return written_.load(std::memory_order_relaxed); }
  std::uint64_t popped() const noexcept { return read_.load(std::memory_order_relaxed); }

 private:
  struct Cell {
    T value{};
    std::atomic<std::uint64_t> stamp{0};  // the number of the push that filled it, from 1; 0: never
  };
  const std::size_t capacity_;
  const std::size_t mask_;
  const std::unique_ptr<Cell[]> cells_;
  alignas(kSeparationBytes) std::atomic<std::uint64_t> written_{0};  // the producer's lines
  std::uint64_t read_seen_ = 0;
  alignas(kSeparationBytes) std::atomic<std::uint64_t> read_{0};  // the consumer's lines
};

}  // namespace rptv
