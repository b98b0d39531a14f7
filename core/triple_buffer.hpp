// SPDX-License-Identifier: MIT
// Large state that one thread renews now and then and another reads all the time, without waiting for each other.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "core/spsc_ring.hpp"

namespace rptv {

/// Three copies: the writer works on one, the reader reads one, the newest finished one lies between them and changes
/// hands by one atomic exchange. Wait-free; nothing allocates after construction.
template <class T>
class TripleBuffer {
 public:
  explicit TripleBuffer(const T& initial) : copies_{initial, initial, initial} {}

  /// Writer only: the copy to work on. It holds what was published two times ago, or the initial value.
  T& back() noexcept { return copies_[mine_]; }
  /// Writer only: the copy becomes the newest; back() is another one from now on.
  void publish() noexcept {
    // acq_rel: releases the copy that we wrote, acquires the one that we get (the reader is done with it).
    mine_ = middle_.exchange(static_cast<std::uint8_t>(mine_ | kFresh), std::memory_order_acq_rel) & kIndex;
  }
  /// Reader only: takes the newest copy; false when front() is the newest already.
  bool refresh() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return false;  // only the reader lowers the flag
    theirs_ = middle_.exchange(theirs_, std::memory_order_acq_rel) & kIndex;
    return true;
  }
  /// Reader only.
  const T& front() const noexcept { return copies_[theirs_]; }

 private:
  static constexpr std::uint8_t kIndex = 3, kFresh = 4;
  std::array<T, 3> copies_;
  alignas(kCacheLineBytes) std::atomic<std::uint8_t> middle_{1};
  alignas(kCacheLineBytes) std::uint8_t mine_ = 0;
  alignas(kCacheLineBytes) std::uint8_t theirs_ = 2;
};

}  // namespace rptv
