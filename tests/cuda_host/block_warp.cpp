// SPDX-License-Identifier: MIT
// Meetings of a warp's lanes: who of a mask must come, what a shuffle or a ballot returns, and what is wrong with a
// mask.
#include <cstdio>
#include <string_view>

#include "tests/cuda_host/block.hpp"

namespace rptv::cuda_host {
namespace {

unsigned bit(unsigned lane) { return 1u << lane; }
unsigned lowest(unsigned lanes) { return static_cast<unsigned>(__builtin_ctz(lanes)); }

std::string hex(unsigned mask) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%08x", mask);
  return text;
}

bool same_call(const CudaThread& a, const CudaThread& b) {
  return a.meeting == b.meeting && a.site.line == b.site.line && std::string_view(a.site.file) == b.site.file;
}

}  // namespace

void Block::meet_in_warp(std::size_t warp, unsigned lane) {
  const CudaThread& first = at(warp, lane);
  if ((first.mask & bit(lane)) == 0) {
    blame(first, printed(first.site) + ": the mask " + hex(first.mask) + " leaves out lane " + std::to_string(lane) +
                     " itself");
    return;
  }
  const unsigned needed = first.mask & warps_[warp].alive;
  if ((warps_[warp].waiting & needed) != needed) return;
  for (unsigned left = needed; left != 0; left &= left - 1) {
    if (at(warp, lowest(left)).mask != first.mask) return;
  }
  finish_group(warp, first.mask, needed);
}

void Block::leave_warp(std::size_t warp, unsigned lane) {
  warps_[warp].alive &= ~bit(lane);
  for (unsigned left = warps_[warp].waiting; left != 0 && !faulty_; left &= left - 1) {
    if ((warps_[warp].waiting & bit(lowest(left))) != 0) meet_in_warp(warp, lowest(left));
  }
}

bool Block::finish_group(std::size_t warp, unsigned mask, unsigned group) {
  const CudaThread& first = at(warp, lowest(group));
  unsigned ballot = 0;
  for (unsigned left = group; left != 0; left &= left - 1) {
    const unsigned lane = lowest(left);
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
  storage_.warp_met(warp, lowest(mask));
  warps_[warp].waiting &= ~group;
  for (unsigned left = group; left != 0; left &= left - 1) {
    CudaThread& thread = at(warp, lowest(left));
    thread.state = ThreadState::kReady;
    thread.result = 0;
    if (thread.meeting == Meeting::kBallot) thread.result = ballot;
    if (thread.meeting == Meeting::kExchange) thread.result = at(warp, thread.source_lane).value;
  }
  return true;
}

}  // namespace rptv::cuda_host
