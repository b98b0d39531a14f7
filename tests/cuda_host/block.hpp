// SPDX-License-Identifier: MIT
// One CUDA block while it runs: continues its threads in turn, lets them meet, and says why where they cannot.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tests/cuda_host/block_storage.hpp"
#include "tests/cuda_host/cuda_thread.hpp"

namespace rptv::cuda_host {

class Block {
 public:
  struct Shape {
    dim3 threads;
    std::size_t dynamic_bytes;
    std::size_t shared_limit_bytes;
  };

  /// `order`: the threads' numbers in the order in which they take their turns.
  Block(uint3 index, std::size_t number, const Shape& shape, const std::vector<std::uint32_t>& order,
        FiberPool& fibers);

  /// To the end of all threads. Returns false where the kernel is at fault; fault() then says how.
  bool run();
  const std::string& fault() const { return fault_; }

  BlockStorage& storage() { return storage_; }

 private:
  void advance(CudaThread& thread);
  void meet_in_block();                                // when no thread is left that could go on
  void meet_in_warp(std::size_t warp, unsigned lane);  // lets the group that this lane waits with go, if it is complete
  void leave_warp(std::size_t warp, unsigned lane);
  bool finish_group(std::size_t warp, unsigned mask, unsigned group);
  CudaThread& at(std::size_t warp, unsigned lane) { return threads_[warp * 32 + lane]; }
  bool blame(const CudaThread& thread, const std::string& what);
  std::string who_waits() const;
  void abandon();

  /// Lanes that wait for others of their warp, and lanes that have not left the kernel.
  struct Warp {
    unsigned waiting = 0, alive = 0;
  };

  uint3 index_;
  std::size_t number_;
  const std::vector<std::uint32_t>& order_;
  FiberPool& fibers_;
  BlockStorage storage_;
  std::vector<CudaThread> threads_;
  std::vector<Warp> warps_;
  std::size_t exited_ = 0;
  bool faulty_ = false;
  std::string fault_;
};

std::string printed(Site site);
std::string printed(uint3 index);

}  // namespace rptv::cuda_host
