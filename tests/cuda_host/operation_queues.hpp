// SPDX-License-Identifier: MIT
// Work that waits to be waited for: queues in order, each operation after what it waits for in other queues, none
// earlier than somebody needs it. The streams of the device are one set of such queues, a graph is another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

namespace rptv::cuda_host {

/// The first `count` operations of a queue.
struct Position {
  std::size_t queue = 0;
  std::uint64_t count = 0;
};

struct Operation {
  std::function<void()> execute;
  std::vector<Position> waits_for;
  const void* host_memory = nullptr;  // a copy's page-locked side
  std::size_t host_bytes = 0;
};

class OperationQueues {
 public:
  std::size_t add_queue();
  void push(std::size_t queue, Operation operation);

  /// Runs what `until` names and what that waits for, and nothing else.
  void run(Position until);
  void run_all();
  bool has_run(Position position) const { return queues_[position.queue].done >= position.count; }
  Position end_of(std::size_t queue) const;
  std::size_t size() const { return queues_.size(); }

  /// Whether a copy is queued that reads or writes there.
  bool uses(const void* host_memory, std::size_t bytes) const;

  /// Whether every operation of every queue runs before the end of this one.
  bool all_join(std::size_t queue) const;

 private:
  struct Queue {
    std::deque<Operation> waiting;
    std::uint64_t done = 0;
  };
  void mark_needed(Position until, std::vector<std::uint64_t>& needed) const;

  std::deque<Queue> queues_;
};

}  // namespace rptv::cuda_host
