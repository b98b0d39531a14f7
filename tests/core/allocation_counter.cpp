// SPDX-License-Identifier: MIT
// malloc and its family, counted and passed on to glibc's own; operator new and delete of libstdc++ call these.
#include "tests/core/allocation_counter.hpp"

#include <atomic>
#include <cerrno>
#include <cstddef>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define RPTV_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define RPTV_SANITIZED
#endif
#endif

namespace rptv {
namespace {

// Constant-initialised: malloc is called before any constructor runs.
std::atomic<bool> armed{false};
std::atomic<std::uint64_t> allocation_count{0};
std::atomic<std::uint64_t> release_count{0};

}  // namespace

AllocationCounter::AllocationCounter() noexcept {
  allocation_count.store(0);
  release_count.store(0);
  armed.store(true);
}
AllocationCounter::~AllocationCounter() { disarm(); }
std::uint64_t AllocationCounter::disarm() noexcept {
  armed.store(false);
  return allocations();
}
std::uint64_t AllocationCounter::allocations() const noexcept { return allocation_count.load(); }
std::uint64_t AllocationCounter::releases() const noexcept { return release_count.load(); }

#ifdef RPTV_SANITIZED
const bool AllocationCounter::kCounts = false;
#else
const bool AllocationCounter::kCounts = true;

namespace {
void count_allocation() noexcept {
  if (armed.load(std::memory_order_relaxed)) allocation_count.fetch_add(1, std::memory_order_relaxed);
}
}  // namespace
#endif

}  // namespace rptv

#ifndef RPTV_SANITIZED
extern "C" {

// glibc's own entries, which stay reachable under these names when malloc is replaced.
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* old, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
void __libc_free(void* memory);

void* malloc(std::size_t bytes) noexcept {
  rptv::count_allocation();
  return __libc_malloc(bytes);
}
void* calloc(std::size_t count, std::size_t bytes) noexcept {
  rptv::count_allocation();
  return __libc_calloc(count, bytes);
}
void* realloc(void* old, std::size_t bytes) noexcept {
  rptv::count_allocation();
  return __libc_realloc(old, bytes);
}
void* memalign(std::size_t alignment, std::size_t bytes) noexcept {
  rptv::count_allocation();
  return __libc_memalign(alignment, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) noexcept { return memalign(alignment, bytes); }
int posix_memalign(void** memory, std::size_t alignment, std::size_t bytes) noexcept {
  *memory = memalign(alignment, bytes);
  return *memory == nullptr ? ENOMEM : 0;
}
void free(void* memory) noexcept {
  if (memory != nullptr && rptv::armed.load(std::memory_order_relaxed))
    rptv::release_count.fetch_add(1, std::memory_order_relaxed);
  __libc_free(memory);
}

}  // extern "C"
#endif
