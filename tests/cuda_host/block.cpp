// SPDX-License-Identifier: MIT
// Turns of a block's threads, and the meetings of all of them; those of a warp's lanes are in block_warp.cpp.
#include "tests/cuda_host/block.hpp"

#include <map>
#include <tuple>

#include "tests/cuda_host/kernel_language.hpp"

uint3 threadIdx;
uint3 blockIdx;
dim3 blockDim;
dim3 gridDim;

namespace rptv::cuda_host {

std::string printed(Site site) { return std::string(site.file) + ':' + std::to_string(site.line); }

std::string printed(uint3 index) {
  return '(' + std::to_string(index.x) + ',' + std::to_string(index.y) + ',' + std::to_string(index.z) + ')';
}

Block::Block(uint3 index, std::size_t number, const Shape& shape, const std::vector<std::uint32_t>& order,
             FiberPool& fibers)
    : index_(index),
      number_(number),
      order_(order),
      fibers_(fibers),
      storage_(shape.dynamic_bytes, shape.shared_limit_bytes, (order.size() + 31) / 32),
      threads_(order.size()),
      warps_((order.size() + 31) / 32) {
  for (std::size_t i = 0; i < threads_.size(); ++i) {
    const auto n = static_cast<unsigned>(i);
    const dim3 size = shape.threads;
    threads_[i].fiber = fibers.take(number, i);
    threads_[i].index = {n % size.x, n / size.x % size.y, n / size.x / size.y};
    threads_[i].lane = n % 32;
    threads_[i].warp = n / 32;
    warps_[n / 32].alive |= 1u << n % 32;
  }
}

bool Block::run() {
  running.block = this;
  blockIdx = index_;
  while (!faulty_ && exited_ < threads_.size()) {
    bool went_on = false;
    for (const std::uint32_t i : order_) {
      if (threads_[i].state != ThreadState::kReady) continue;
      went_on = true;
      advance(threads_[i]);
      if (faulty_) break;
    }
    if (!went_on) meet_in_block();
  }
  if (!faulty_) {
    if (const char* name = storage_.overrun())
      blame(threads_[0], "something wrote past the end of '" + std::string(name) + "'");
  }
  if (faulty_) abandon();
  return !faulty_;
}

void Block::advance(CudaThread& thread) {
  running.thread = &thread;
  threadIdx = thread.index;
  thread.fiber->resume();
  while (thread.state == ThreadState::kWantsArray) {
    const ArrayWish& wish = thread.wish;
    std::string why;
    if (storage_.add(wish.tag, wish.size_bytes, wish.alignment_bytes, wish.name, thread.site, why) == nullptr) {
      blame(thread, why);
      return;
    }
    thread.fiber->resume();
  }
  if (thread.state == ThreadState::kFaulted) {
    blame(thread, printed(thread.site) + ": " + thread.fault);
  } else if (thread.state == ThreadState::kExited) {
    ++exited_;
    leave_warp(thread.warp, thread.lane);
  } else if (thread.meeting != Meeting::kBlock) {
    warps_[thread.warp].waiting |= 1u << thread.lane;
    meet_in_warp(thread.warp, thread.lane);
  }
}

void Block::meet_in_block() {
  std::uint64_t non_zero = 0;
  for (const CudaThread& thread : threads_) {
    const CudaThread& first = threads_[0];
    const bool here = thread.state == ThreadState::kWaiting && thread.meeting == Meeting::kBlock &&
                      thread.site.line == first.site.line && std::string_view(thread.site.file) == first.site.file;
    if (!here) {
      blame(thread, "threads wait that cannot go on: " + who_waits());
      return;
    }
    if (thread.value != 0) ++non_zero;
  }
  storage_.block_met();
  for (CudaThread& thread : threads_) {
    thread.result = non_zero;
    thread.state = ThreadState::kReady;
  }
}

std::string Block::who_waits() const {
  std::map<std::tuple<std::string, int, bool>, unsigned> counts;
  for (const CudaThread& thread : threads_) {
    if (thread.state != ThreadState::kWaiting) continue;
    ++counts[{thread.site.file, thread.site.line, thread.meeting == Meeting::kBlock}];
  }
  std::string text;
  for (const auto& [place, count] : counts) {
    const auto& [file, line, in_block] = place;
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " at the " + (in_block ? "block's" : "warp's") +
            " meeting " + printed(Site{file.c_str(), line});
  }
  if (exited_ > 0) text += ", and " + std::to_string(exited_) + " have left the kernel";
  return text;
}

bool Block::blame(const CudaThread& thread, const std::string& what) {
  faulty_ = true;
  fault_ = "block " + printed(index_) + ", thread " + printed(thread.index) + ": " + what;
  return false;
}

void Block::abandon() {
  for (std::size_t i = 0; i < threads_.size(); ++i) {
    if (threads_[i].state == ThreadState::kExited) continue;
    threads_[i].fiber->release_order(&end_token);
    fibers_.abandon(number_, i);
  }
}

}  // namespace rptv::cuda_host
