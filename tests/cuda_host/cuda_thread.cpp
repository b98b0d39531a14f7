// SPDX-License-Identifier: MIT
// What runs on a CUDA thread's fiber. It only notes what the thread wants and leaves; the block decides. While a fiber
// runs, nothing here may call a function that ThreadSanitizer intercepts or instruments: it would count as the kernel's
// own.
#include "tests/cuda_host/cuda_thread.hpp"

#include <functional>

#include "tests/cuda_host/block.hpp"
#include "tests/cuda_host/sanitizer_hooks.hpp"

namespace rptv::cuda_host {

Running running;
std::uint64_t launch_token, end_token, fence_token;

void run_cuda_thread() {
  acquire(&launch_token);
  (*static_cast<const std::function<void()>*>(running.body))();
  release(&end_token);
  running.thread->state = ThreadState::kExited;
}

unsigned lane() { return running.thread->lane; }

std::uint64_t meet(Meeting kind, unsigned mask, std::uint64_t value, unsigned source_lane, Site site) {
  CudaThread& thread = *running.thread;
  thread.meeting = kind;
  thread.mask = mask;
  thread.value = value;
  thread.source_lane = source_lane;
  thread.site = site;
  thread.state = ThreadState::kWaiting;
  void* token = nullptr;  // shuffles and ballots order nothing
  if (kind == Meeting::kBlock) token = running.block->storage().block_token();
  if (kind == Meeting::kWarp && mask != 0) {
    token = running.block->storage().warp_token(thread.warp, static_cast<unsigned>(__builtin_ctz(mask)));
  }
  if (token != nullptr) release(token);
  Fiber::leave();
  if (token != nullptr) acquire(token);
  return thread.result;
}

void* shared_array(const void* tag, std::size_t size_bytes, std::size_t alignment_bytes, const char* name, Site site) {
  if (void* found = running.block->storage().find(tag)) return found;
  CudaThread& thread = *running.thread;
  thread.wish = {tag, size_bytes, alignment_bytes, name};
  thread.site = site;
  thread.state = ThreadState::kWantsArray;
  Fiber::leave();
  return running.block->storage().find(tag);
}

void* dynamic_shared() { return running.block->storage().dynamic(); }

void fence() {
  release(&fence_token);
  acquire(&fence_token);
  __atomic_signal_fence(__ATOMIC_SEQ_CST);
}

void kernel_fault(const char* what, Site site) {
  running.thread->fault = what;
  running.thread->site = site;
  running.thread->state = ThreadState::kFaulted;
  Fiber::leave();
  __builtin_unreachable();  // the fiber of a fault is not continued
}

std::vector<std::unique_ptr<Fiber>>& FiberPool::set_of(std::size_t block_number) {
  return sets_[kThreadSanitizer ? block_number % 2 : 0];
}

Fiber* FiberPool::take(std::size_t block_number, std::size_t thread) {
  auto& fibers = set_of(block_number);
  if (fibers.size() <= thread) fibers.resize(thread + 1);
  if (fibers[thread] == nullptr) fibers[thread] = std::make_unique<Fiber>(&run_cuda_thread);
  return fibers[thread].get();
}

void FiberPool::abandon(std::size_t block_number, std::size_t thread) { set_of(block_number)[thread].reset(); }

}  // namespace rptv::cuda_host
