// SPDX-License-Identifier: MIT
// What the executor tells AddressSanitizer about stacks and device memory, and ThreadSanitizer about the order of CUDA
// threads; nothing where neither is built in. Sources of the executor are never compiled with ThreadSanitizer
// themselves.
#pragma once

#include <cstddef>

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/asan_interface.h>
#include <sanitizer/common_interface_defs.h>
#endif

#if defined(RPTV_CUDA_HOST_TSAN)
extern "C" {
void __tsan_acquire(void* token);
void __tsan_release(void* token);
void* __tsan_get_current_fiber();
void* __tsan_create_fiber(unsigned flags);
void __tsan_destroy_fiber(void* identity);
void __tsan_switch_to_fiber(void* identity, unsigned flags);
void AnnotateIgnoreReadsBegin(const char* file, int line);
void AnnotateIgnoreReadsEnd(const char* file, int line);
void AnnotateIgnoreWritesBegin(const char* file, int line);
void AnnotateIgnoreWritesEnd(const char* file, int line);
}
#endif

namespace rptv::cuda_host {

#if defined(RPTV_CUDA_HOST_TSAN)
inline constexpr bool kThreadSanitizer = true;
static inline void acquire(void* token) { __tsan_acquire(token); }
static inline void release(void* token) { __tsan_release(token); }
static inline void* current_identity() { return __tsan_get_current_fiber(); }
static inline void* new_identity() { return __tsan_create_fiber(0); }
static inline void drop_identity(void* identity) { __tsan_destroy_fiber(identity); }
static inline void assume_identity(void* identity) { __tsan_switch_to_fiber(identity, 1); }  // 1: orders nothing

/// While it lives, what this thread allocates, frees and fills is no access that could race: it begins without a
/// history.
struct Unobserved {
  Unobserved() {
    AnnotateIgnoreReadsBegin(__FILE__, __LINE__);
    AnnotateIgnoreWritesBegin(__FILE__, __LINE__);
  }
  ~Unobserved() {
    AnnotateIgnoreWritesEnd(__FILE__, __LINE__);
    AnnotateIgnoreReadsEnd(__FILE__, __LINE__);
  }
};
#else
inline constexpr bool kThreadSanitizer = false;
static inline void acquire(void*) {}
static inline void release(void*) {}
static inline void* current_identity() { return nullptr; }
static inline void* new_identity() { return nullptr; }
static inline void drop_identity(void*) {}
static inline void assume_identity(void*) {}
struct Unobserved {
  Unobserved() {}
  ~Unobserved() {}
};
#endif

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kAddressSanitizer = true;
static inline void leave_stack(void** fake_stack, const void* bottom, std::size_t size_bytes) {
  __sanitizer_start_switch_fiber(fake_stack, bottom, size_bytes);
}
static inline void enter_stack(void* fake_stack, const void** left_bottom, std::size_t* left_size_bytes) {
  __sanitizer_finish_switch_fiber(fake_stack, left_bottom, left_size_bytes);
}
static inline void forbid(void* memory, std::size_t size_bytes) { __asan_poison_memory_region(memory, size_bytes); }
static inline void permit(void* memory, std::size_t size_bytes) { __asan_unpoison_memory_region(memory, size_bytes); }
#else
inline constexpr bool kAddressSanitizer = false;
static inline void leave_stack(void**, const void*, std::size_t) {}
static inline void enter_stack(void*, const void**, std::size_t*) {}
static inline void forbid(void*, std::size_t) {}
static inline void permit(void*, std::size_t) {}
#endif

}  // namespace rptv::cuda_host
