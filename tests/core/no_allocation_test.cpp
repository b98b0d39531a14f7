// SPDX-License-Identifier: MIT
// The running path of core allocates nothing, and the counter that says so can count.
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>

#include "core/frame.hpp"
#include "core/hand_over.hpp"
#include "core/latency.hpp"
#include "core/result.hpp"
#include "tests/core/allocation_counter.hpp"

namespace rptv {
namespace {

TEST(AllocationCounter, counts_every_way_to_the_heap) {
  if (!AllocationCounter::kCounts) GTEST_SKIP() << "a sanitizer has replaced malloc";
  void* volatile kept = nullptr;  // volatile: the compiler may not leave a pair of allocation and release out
  AllocationCounter counter;
  kept = std::malloc(8);
  std::free(kept);
  kept = std::aligned_alloc(64, 64);
  std::free(kept);
  kept = operator new(8);
  operator delete(kept);
  kept = operator new (64, std::align_val_t{64});
  operator delete (kept, std::align_val_t{64});
  EXPECT_EQ(counter.disarm(), 4U);
  EXPECT_EQ(counter.releases(), 4U);
  kept = std::malloc(8);
  std::free(kept);
  EXPECT_EQ(counter.allocations(), 4U) << "disarmed";
}

class NoAllocation : public testing::TestWithParam<HandOverPolicy> {};

TEST_P(NoAllocation, in_claim_push_pop_share_and_drop) {
  if (!AllocationCounter::kCounts) GTEST_SKIP() << "a sanitizer has replaced malloc";
  FramePool pool(8, 64);
  ResultPool results(2, [] { return Result(4, 4); });
  Losses losses;
  HandOver<Frame> queue(GetParam(), losses);
  const auto histogram = std::make_unique<LatencyHistogram>();
  std::uint64_t taken = 0;
  AllocationCounter counter;
  for (int i = 0; i < 1000; ++i) {
    for (int k = 0; k < 3; ++k) {
      if (queue.waiting() == 2 && std::holds_alternative<Lossless>(GetParam())) break;
      queue.push(Frame{{}, {}, pool.claim()});
    }
    Frame frame;
    if (queue.pop(frame, 1000) == Taken::value) ++taken;
    const FrameLease second = frame.lease.share();
    ResultLease result = results.claim();
    result->particles.clear();
    for (int k = 0; k < 6; ++k) result->particles.push({});
    histogram->record(i);
  }
  const std::uint64_t allocations = counter.disarm();
  EXPECT_EQ(allocations, 0U);
  EXPECT_EQ(counter.releases(), 0U);
  EXPECT_EQ(taken, 1000U);
}

INSTANTIATE_TEST_SUITE_P(EveryPolicy, NoAllocation, testing::Values(Newest{}, Lossless{2}, Bounded{2}));

}  // namespace
}  // namespace rptv
