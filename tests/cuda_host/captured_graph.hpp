// SPDX-License-Identifier: MIT
// A graph: the queues that its capture filled, of which each launch runs a copy.
#pragma once

#include <vector>

#include "tests/cuda_host/graph_api.hpp"
#include "tests/cuda_host/operation_queues.hpp"

struct CUgraph_st {
  rptv::cuda_host::OperationQueues queues;
  std::vector<CUstream_st*> joined;  // streams in the capture; the first began it, its queue is 0
  bool invalid = false;
};

struct CUgraphExec_st {
  rptv::cuda_host::OperationQueues queues;
};
