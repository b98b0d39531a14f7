// SPDX-License-Identifier: MIT
// Runs queued operations as late as it may.
#include "tests/cuda_host/operation_queues.hpp"

#include <algorithm>
#include <utility>

namespace rptv::cuda_host {

std::size_t OperationQueues::add_queue() {
  queues_.emplace_back();
  return queues_.size() - 1;
}

void OperationQueues::push(std::size_t queue, Operation operation) {
  queues_[queue].waiting.push_back(std::move(operation));
}

Position OperationQueues::end_of(std::size_t queue) const {
  return {queue, queues_[queue].done + queues_[queue].waiting.size()};
}

void OperationQueues::run(Position until) {
  while (!has_run(until)) {
    Queue& queue = queues_[until.queue];
    const Operation operation = std::move(queue.waiting.front());
    queue.waiting.pop_front();
    for (const Position& other : operation.waits_for) run(other);
    operation.execute();
    ++queue.done;
  }
}

void OperationQueues::run_all() {
  for (std::size_t queue = 0; queue < queues_.size(); ++queue) run(end_of(queue));
}

bool OperationQueues::uses(const void* host_memory, std::size_t bytes) const {
  const auto* begin = static_cast<const unsigned char*>(host_memory);
  for (const Queue& queue : queues_) {
    for (const Operation& operation : queue.waiting) {
      const auto* other = static_cast<const unsigned char*>(operation.host_memory);
      if (other != nullptr && other < begin + bytes && begin < other + operation.host_bytes) return true;
    }
  }
  return false;
}

void OperationQueues::mark_needed(Position until, std::vector<std::uint64_t>& needed) const {
  for (std::uint64_t i = needed[until.queue]; i < until.count; ++i) {
    needed[until.queue] = std::max(needed[until.queue], i + 1);
    for (const Position& other : queues_[until.queue].waiting[i].waits_for) mark_needed(other, needed);
  }
}

bool OperationQueues::all_join(std::size_t queue) const {
  std::vector<std::uint64_t> needed(queues_.size(), 0);
  mark_needed(end_of(queue), needed);
  for (std::size_t other = 0; other < queues_.size(); ++other) {
    if (needed[other] < end_of(other).count) return false;
  }
  return true;
}

}  // namespace rptv::cuda_host
