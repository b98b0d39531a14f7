// SPDX-License-Identifier: MIT
// The right to use one slot of a pool; giving it up returns the slot.
#pragma once

#include <cstddef>
#include <utility>

namespace rptv {

/// Move-only. A lease belongs to one thread at a time; hand it over through a ring. `share()` makes a second lease of
/// the same slot for another reader: from then on the slot's content must not change. The pool must outlive its leases.
/// `Pool` has `element(slot)`, `share(slot)` and `drop(slot)`.
template <class Pool>
class Lease {
 public:
  Lease() = default;
  Lease(Pool* pool, std::size_t slot) noexcept : pool_(pool), slot_(slot) {}
  Lease(Lease&& other) noexcept : pool_(std::exchange(other.pool_, nullptr)), slot_(other.slot_) {}
  Lease& operator=(Lease&& other) noexcept {
    if (this != &other) {
      reset();
      pool_ = std::exchange(other.pool_, nullptr);
      slot_ = other.slot_;
    }
    return *this;
  }
  Lease(const Lease&) = delete;
  Lease& operator=(const Lease&) = delete;
  ~Lease() { reset(); }

  explicit operator bool() const noexcept { return pool_ != nullptr; }
  auto* get() const noexcept { return pool_->element(slot_); }
  auto* operator->() const noexcept { return get(); }
  auto& operator*() const noexcept { return *get(); }
  std::size_t slot() const noexcept { return slot_; }

  Lease share() const noexcept {
    if (pool_ == nullptr) return {};
    pool_->share(slot_);
    return Lease(pool_, slot_);
  }
  void reset() noexcept {
    if (pool_ != nullptr) std::exchange(pool_, nullptr)->drop(slot_);
  }

 private:
  Pool* pool_ = nullptr;
  std::size_t slot_ = 0;
};

}  // namespace rptv
