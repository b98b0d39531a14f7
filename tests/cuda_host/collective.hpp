// SPDX-License-Identifier: MIT
// What a running CUDA thread asks of the executor: to meet other threads of its block or warp, and memory that they
// share.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rptv::cuda_host {

/// Where a kernel called something, for messages.
struct Site {
  const char* file;
  int line;
};

enum class Meeting : std::uint8_t { kBlock, kWarp, kExchange, kBallot };

/// Waits for the other threads of the meeting, which must come to the same place in the source. `mask` names the lanes
/// of a meeting within a warp. Returns: kBlock: the number of threads whose `value` is not zero; kBallot: the lanes
/// where it is not; kExchange: the `value` of lane `source_lane`; kWarp: 0.
std::uint64_t meet(Meeting kind, unsigned mask, std::uint64_t value, unsigned source_lane, Site site);

/// The lane of the running thread within its warp, 0 to 31.
unsigned lane();

/// An array of the block, filled with 0xA5 when its first thread asks for it; `tag` tells one array from another.
void* shared_array(const void* tag, std::size_t size_bytes, std::size_t alignment_bytes, const char* name, Site site);

/// The block's dynamic shared memory, as large as the launch said.
void* dynamic_shared();

/// __threadfence(): orders what this thread did before with what threads do that pass a fence later.
void fence();

/// Ends the launch with an error; does not return.
[[noreturn]] void kernel_fault(const char* what, Site site);

}  // namespace rptv::cuda_host
