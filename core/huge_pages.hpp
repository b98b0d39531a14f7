// SPDX-License-Identifier: MIT
// Memory for tables that are read all over: in pages of 2 MiB where the system has them.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>

namespace rptv {

/// An allocator for vectors. Small pages would cost a walk through the page table at almost every look into a table of
/// tens of MiB. Only advice: without huge pages everything works the same. Throws std::bad_alloc.
template <class T>
struct HugePages {
  using value_type = T;
  static constexpr std::size_t kPageBytes = std::size_t{1} << 21;

  HugePages() = default;
  template <class U>
  HugePages(const HugePages<U>&) noexcept {}

  T* allocate(std::size_t count) {
    const std::size_t page = count * sizeof(T) < kPageBytes ? 64 : kPageBytes;
    const std::size_t bytes = (count * sizeof(T) + page - 1) / page * page;
    void* memory = std::aligned_alloc(page, bytes);
    if (memory == nullptr) throw std::bad_alloc();
    if (page == kPageBytes) madvise(memory, bytes, MADV_HUGEPAGE);
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t) noexcept { std::free(memory); }
  template <class U>
  bool operator==(const HugePages<U>&) const noexcept {
    return true;
  }
};

}  // namespace rptv
