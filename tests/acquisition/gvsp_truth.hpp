// SPDX-License-Identifier: MIT
// What the test camera really did, kept where it outlives a camera that is killed.
#pragma once

#include <atomic>
#include <cstdint>

namespace rptv {

/// Of one life of a camera. Plain lock-free words: may lie in memory that two processes share. Written by the camera.
struct GvspTruth {
  std::atomic<std::int64_t> first_answer_ns{0};  ///< CLOCK_MONOTONIC at its first reply to anybody
  std::atomic<std::uint64_t> begun{0};           ///< images of which at least one packet may have left
  std::atomic<std::uint64_t> sent{0};            ///< images of which every packet has left, or was lost by intent
  std::atomic<std::uint64_t> resent{0};          ///< packets, on request
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

}  // namespace rptv
