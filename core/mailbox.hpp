// SPDX-License-Identifier: MIT
// A one-place hand-over that always holds the newest value: the producer replaces, the consumer takes.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "core/spsc_ring.hpp"

namespace rptv {

/// Triple buffer: each side owns one cell, the third lies between them and changes hands by one atomic exchange.
/// Wait-free for one producer and one consumer. T is default constructible and nothrow movable, and a moved-from T
/// holds no resource (a lease does not): a cell keeps its moved-from value until it is written again.
template <class T>
class Mailbox {
 public:
  /// Producer only. Returns true when an unread value was replaced; that value is moved into `replaced`.
  bool put(T&& value, T& replaced) noexcept {
    cells_[mine_].value = std::move(value);
    // acq_rel: releases the cell that we filled, acquires the one that we get back (the consumer is done with it).
    const std::uint8_t previous =
        middle_.exchange(static_cast<std::uint8_t>(mine_ | kFresh), std::memory_order_acq_rel);
    mine_ = previous & kIndex;
    if ((previous & kFresh) == 0) return false;
    replaced = std::move(cells_[mine_].value);
    return true;
  }

  /// Consumer only. False when nothing new has come since the last take.
  bool take(T& value) noexcept {
    if (!fresh()) return false;  // relaxed is enough: only the consumer lowers the flag, the exchange below acquires
    // acq_rel: acquires the cell that the producer filled, releases the one that we are done with.
    theirs_ = middle_.exchange(theirs_, std::memory_order_acq_rel) & kIndex;
    value = std::move(cells_[theirs_].value);
    return true;
  }

  /// Any thread: a value waits, at some moment during the call.
  bool fresh() const noexcept { return (middle_.load(std::memory_order_relaxed) & kFresh) != 0; }

 private:
  static constexpr std::uint8_t kIndex = 3;
  static constexpr std::uint8_t kFresh = 4;
  static_assert(std::is_nothrow_move_assignable_v<T> && std::is_default_constructible_v<T>);
  struct alignas(kCacheLineBytes) Cell {  // own lines: the two sides fill and empty theirs at the same time
    T value{};
  };
  std::array<Cell, 3> cells_;
  alignas(kCacheLineBytes) std::atomic<std::uint8_t> middle_{1};
  alignas(kCacheLineBytes) std::uint8_t mine_ = 0;
  alignas(kCacheLineBytes) std::uint8_t theirs_ = 2;
};

}  // namespace rptv
