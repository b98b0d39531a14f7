// SPDX-License-Identifier: MIT
// One CUDA thread of the block that runs: its fiber, and what it waits for. And the fibers, which serve block after
// block.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/cuda_host/collective.hpp"
#include "tests/cuda_host/fiber.hpp"
#include "tests/cuda_host/vector_types.hpp"

namespace rptv::cuda_host {

enum class ThreadState : std::uint8_t { kReady, kWaiting, kWantsArray, kFaulted, kExited };

/// A shared array that a thread is the first to ask for.
struct ArrayWish {
  const void* tag;
  std::size_t size_bytes;
  std::size_t alignment_bytes;
  const char* name;
};

struct CudaThread {
  Fiber* fiber = nullptr;
  uint3 index{};
  unsigned lane = 0;
  std::size_t warp = 0;
  ThreadState state = ThreadState::kReady;
  Meeting meeting{};  // while it waits, from here
  unsigned mask = 0;
  std::uint64_t value = 0;
  unsigned source_lane = 0;
  Site site{};
  std::uint64_t result = 0;
  ArrayWish wish{};
  const char* fault = nullptr;
};

/// What a fiber's code may look at: no other part of the executor is touched while a CUDA thread runs.
struct Running {
  CudaThread* thread = nullptr;
  class Block* block = nullptr;
  const void* body = nullptr;  // std::function<void()>
};
extern Running running;

/// Order of a launch as a whole, for ThreadSanitizer: before any thread, after all threads, across fences.
extern std::uint64_t launch_token, end_token, fence_token;

/// Runs the kernel's body as the running thread; the body of each fiber.
void run_cuda_thread();

/// Fibers by thread number. Neighbouring blocks take different ones where ThreadSanitizer would otherwise see one
/// thread of execution in both, and no race between them.
class FiberPool {
 public:
  Fiber* take(std::size_t block_number, std::size_t thread);
  /// Forgets a fiber whose thread will never end.
  void abandon(std::size_t block_number, std::size_t thread);

 private:
  std::vector<std::unique_ptr<Fiber>>& set_of(std::size_t block_number);
  std::vector<std::unique_ptr<Fiber>> sets_[2];
};

}  // namespace rptv::cuda_host
