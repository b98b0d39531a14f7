// SPDX-License-Identifier: MIT
// Meetings of a warp's lanes: who of a mask must come, what a shuffle or a ballot returns, and what is wrong with a
// mask.
#include <cstdio>
#include <string_view>

#include "tests/cuda_host/block.hpp"

namespace rptv::cuda_host {
namespace {

unsigned bit(unsigned lane) { return 1u << lane; }

std::string hex(unsigned mask) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%08x", mask);
  return text;
}

bool same_call(const CudaThread& a, const CudaThread& b) {
  return a.meeting == b.meeting && a.site.line == b.site.line && std::string_view(a.site.file) == b.site.file;
}

}  // namespace

unsigned Block::lanes_in(std::size_t warp, ThreadState state) const {
  unsigned lanes = 0;
  for (unsigned lane = 0; lane < 32 && warp * 32 + lane < threads_.size(); ++lane) {
    if (threads_[warp * 32 + lane].state == state) lanes |= bit(lane);
  }
  return lanes;
}

void Block::meet_in_warp(std::size_t warp) {
  const unsigned waiting = lanes_in(warp, ThreadState::kWaiting);
  const unsigned alive = waiting | lanes_in(warp, ThreadState::kReady);
  for (unsigned left = waiting; left != 0 && !faulty_;) {
    const auto lane = static_cast<unsigned>(__builtin_ctz(left));
    left &= ~bit(lane);
    const CudaThread& first = at(warp, lane);
    if (first.meeting == Meeting::kBlock) continue;
    if ((first.mask & bit(lane)) == 0) {
      blame(first, printed(first.site) + ": the mask " + hex(first.mask) + " leaves out lane " + std::to_string(lane) +
                       " itself");
      return;
    }
    unsigned group = 0;
    for (unsigned other = 0; other < 32; ++other) {
      if ((waiting & bit(other)) == 0) continue;
      const CudaThread& thread = at(warp, other);
      if (thread.meeting != Meeting::kBlock && thread.mask == first.mask) group |= bit(other);
    }
    left &= ~(group & first.mask);
    if ((group & first.mask) == (first.mask & alive)) finish_group(warp, first.mask, group & first.mask);
  }
}

bool Block::finish_group(std::size_t warp, unsigned mask, unsigned group) {
  const auto first_lane = static_cast<unsigned>(__builtin_ctz(group));
  const CudaThread& first = at(warp, first_lane);
  unsigned ballot = 0;
  for (unsigned lane = 0; lane < 32; ++lane) {
    if ((group & bit(lane)) == 0) continue;
    const CudaThread& thread = at(warp, lane);
    if (!same_call(first, thread)) {
      return blame(thread, "lanes of mask " + hex(mask) + " meet in different calls: " + printed(first.site) + " and " +
                               printed(thread.site));
    }
    if (thread.value != 0) ballot |= bit(lane);
    if (thread.meeting == Meeting::kExchange && (group & bit(thread.source_lane)) == 0) {
      return blame(thread, printed(thread.site) + ": the shuffle reads lane " + std::to_string(thread.source_lane) +
                               ", which takes no part in it (mask " + hex(mask) + ")");
    }
  }
  storage_.warp_met(warp, static_cast<unsigned>(__builtin_ctz(mask)));
  for (unsigned lane = 0; lane < 32; ++lane) {
    if ((group & bit(lane)) == 0) continue;
    CudaThread& thread = at(warp, lane);
    thread.state = ThreadState::kReady;
    thread.result = 0;
    if (thread.meeting == Meeting::kBallot) thread.result = ballot;
    if (thread.meeting == Meeting::kExchange) thread.result = at(warp, thread.source_lane).value;
  }
  return true;
}

}  // namespace rptv::cuda_host
