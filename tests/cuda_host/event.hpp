// SPDX-License-Identifier: MIT
// An event: a place in a queue of the device or of a graph, and when it was passed.
#pragma once

#include <chrono>
#include <memory>

#include "tests/cuda_host/captured_graph.hpp"
#include "tests/cuda_host/operation_queues.hpp"
#include "tests/cuda_host/stream_api.hpp"

struct CUevent_st {
  bool times = true;
  bool recorded = false;
  rptv::cuda_host::Position position;
  CUgraph_st* graph = nullptr;  // recorded in a capture
  std::shared_ptr<std::chrono::steady_clock::time_point> passed;
  int polls = 0;
};
