// SPDX-License-Identifier: MIT
// A fixed number of ready-made objects, handed out by lease: how results travel between stages without allocation.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "core/lease.hpp"
#include "core/slot_book.hpp"
#include "core/wake.hpp"

namespace rptv {

/// Objects are built once and reused; a claimed object holds what its last user left in it. Thread contract: as
/// FramePool.
template <class T>
class ObjectPool {
 public:
  template <class Make>
  ObjectPool(std::size_t slots, Make make) : book_(slots) {
    objects_.reserve(slots);
    for (std::size_t i = 0; i < slots; ++i) objects_.push_back(std::make_unique<T>(make()));
  }

  Lease<ObjectPool> claim() noexcept {
    const std::size_t slot = book_.claim();
    return slot == SlotBook::kNone ? Lease<ObjectPool>() : Lease<ObjectPool>(this, slot);
  }
  std::uint32_t prepare_to_wait() const noexcept { return returned_.prepare(); }
  void wait_for_slot(std::uint32_t seen, std::int64_t timeout_ns) noexcept { returned_.wait(seen, timeout_ns); }
  std::size_t free_slots() const noexcept { return book_.free_slots(); }

  T* element(std::size_t slot) noexcept { return objects_[slot].get(); }
  void share(std::size_t slot) noexcept { book_.share(slot); }
  void drop(std::size_t slot) noexcept {
    if (book_.drop(slot)) returned_.notify();
  }

 private:
  SlotBook book_;
  std::vector<std::unique_ptr<T>> objects_;
  Wake returned_;
};

}  // namespace rptv
