// SPDX-License-Identifier: MIT
// Memory that is read all over, or by the MiB: in pages of 2 MiB where the system has them.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>

namespace rptv {

/// At least `bytes`, aligned to at least `alignment`; null when there is no memory. For std::free(). An image or a
/// table of some MiB lies on hundreds of small pages, and each costs a look-up in the page table. Huge pages are advice
/// only: without them everything works the same.
inline void* allocate_in_huge_pages(std::size_t bytes, std::size_t alignment) noexcept {
  constexpr std::size_t kHuge = std::size_t{1} << 21;
  const std::size_t page = bytes < kHuge ? alignment : kHuge;
  bytes = (bytes + page - 1) / page * page;
  void* memory = std::aligned_alloc(page, bytes);
  if (memory != nullptr && page == kHuge) madvise(memory, bytes, MADV_HUGEPAGE);
  return memory;
}

/// The same as an allocator for vectors. Throws std::bad_alloc.
template <class T>
struct HugePages {
  using value_type = T;

  HugePages() = default;
  template <class U>
  HugePages(const HugePages<U>&) noexcept {}

  T* allocate(std::size_t count) {
    void* memory = allocate_in_huge_pages(count * sizeof(T), 64);
    if (memory == nullptr) throw std::bad_alloc();
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t) noexcept { std::free(memory); }
  template <class U>
  bool operator==(const HugePages<U>&) const noexcept {
    return true;
  }
};

}  // namespace rptv
