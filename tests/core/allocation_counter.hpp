// SPDX-License-Identifier: MIT
// Counts heap allocations of the whole process while armed: the proof that a running path makes none.
#pragma once

#include <cstdint>

namespace rptv {

/// Link the object library `rptv_allocation_counter`: it replaces malloc and its family (and with them operator new) in
/// the test's binary. Under AddressSanitizer and ThreadSanitizer, which replace them themselves, nothing is counted:
/// `kCounts` is false, and tests of the count should GTEST_SKIP.
///
/// Any thread may arm, disarm and allocate; one counter for all threads. Arm it when every thread is warmed up.
class AllocationCounter {
 public:
  static const bool kCounts;

  /// Counts from here to disarm() or the end of scope. One at a time.
  AllocationCounter() noexcept;
  ~AllocationCounter();
  AllocationCounter(const AllocationCounter&) = delete;
  AllocationCounter& operator=(const AllocationCounter&) = delete;

  /// Stops counting; returns allocations() so far. To be called before an expectation, which may allocate.
  std::uint64_t disarm() noexcept;
  std::uint64_t allocations() const noexcept;  ///< calls of malloc, calloc, realloc, aligned_alloc, operator new, …
  std::uint64_t releases() const noexcept;     ///< calls of free with something to free
};

}  // namespace rptv
