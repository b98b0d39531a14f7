// SPDX-License-Identifier: MIT
// The one loop over threads of the CPU backend: OpenMP where the compiler has it, else the calling thread alone; under
// ThreadSanitizer, which does not understand OpenMP, threads that are begun for the loop.
#pragma once

#include <cstddef>
#include <cstdint>
#if defined(_OPENMP)
#include <omp.h>
#elif defined(__SANITIZE_THREAD__)
#include <atomic>
#include <thread>
#include <vector>
#endif

namespace rptv {

/// Threads that `asked` stands for; 0: all that the machine has.
inline std::size_t thread_count(std::int64_t asked) noexcept {
#if defined(_OPENMP)
  return asked > 0 ? static_cast<std::size_t>(asked) : static_cast<std::size_t>(omp_get_num_procs());
#else
  static_cast<void>(asked);
  return 1;
#endif
}

/// work(item, thread) for every item in 0..count-1, in no order; `thread` < threads tells workspaces apart. `work` must
/// not throw. OpenMP keeps its threads, so that nothing is allocated after the first call from a thread.
template <class Work>
void parallel_for(std::size_t count, std::size_t threads, const Work& work) noexcept {
#if defined(_OPENMP)
  if (threads > 1 && count > 1) {
#pragma omp parallel for num_threads(static_cast <int>(threads)) schedule(dynamic, 1)
    for (std::size_t item = 0; item < count; ++item) work(item, static_cast<std::size_t>(omp_get_thread_num()));
    return;
  }
#elif defined(__SANITIZE_THREAD__)
  if (threads > 1 && count > 1) {
    std::atomic<std::size_t> next{0};
    const auto share = [&](std::size_t thread) {
      for (std::size_t item; (item = next.fetch_add(1, std::memory_order_relaxed)) < count;) work(item, thread);
    };
    std::vector<std::jthread> others;
    for (std::size_t thread = 1; thread < threads; ++thread) others.emplace_back(share, thread);
    share(0);
    return;
  }
#endif
  static_cast<void>(threads);
  for (std::size_t item = 0; item < count; ++item) work(item, std::size_t{0});
}

}  // namespace rptv
