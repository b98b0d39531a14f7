// SPDX-License-Identifier: MIT
// Intake takes all its memory when it is made: claim, deliver, bundling and next allocate nothing.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <tuple>

#include "tests/acquisition/made_frame.hpp"
#include "tests/core/allocation_counter.hpp"

namespace rptv {
namespace {

class IntakeAllocation : public testing::TestWithParam<std::tuple<HandOverPolicy, PairBy>> {
 protected:
  static IntakeOptions options() {
    IntakeOptions options{std::get<HandOverPolicy>(GetParam()), 16, 4, 10'000};
    options.pairing = {std::get<PairBy>(GetParam()), false, 1'000};
    options.bound_ns = 100'000;
    return options;
  }
};

// Every kind of frame passes: whole, torn, twice, late, skipped, without a slot, with and without partners.
void disturb(Intake& intake, std::uint32_t cameras, std::uint64_t index) {
  for (std::uint32_t camera = 0; camera < cameras; ++camera) {
    if ((index + camera) % 7 == 0) continue;
    send(intake, camera, index, (index + camera) % 11 == 0);
    if (index % 5 == 0) send(intake, camera, index);
    if (index % 13 == 0) send(intake, camera, index - 2);
    if (index % 17 == 0) intake.lose(camera, LossCause::source_gap, 1);
  }
}

template <class Condition>
bool eventually(const Condition& condition) {
  const std::int64_t deadline_ns = host_now_ns() + kLongNs;
  while (!condition() && host_now_ns() < deadline_ns) std::this_thread::yield();
  return condition();
}

/// Takes sets on a thread of its own, as a pipeline does: under Lossless the sources wait for it.
class Consumer {
 public:
  explicit Consumer(Intake& intake) : thread_([this, &intake] { run(intake); }) {}
  ~Consumer() {
    let_go_ = true;
    thread_.join();
  }
  bool reaches(std::uint64_t sets) const {
    return eventually([&] { return sets_.load() >= sets; });
  }
  bool ends() const {
    return eventually([&] { return ended_.load(); });
  }
  std::uint64_t sets() const { return sets_.load(); }

 private:
  void run(Intake& intake) {
    FrameSet set;
    for (Taken taken; (taken = intake.next(set, kLongNs)) != Taken::closed;)
      if (taken == Taken::value) sets_.fetch_add(1);
    ended_ = true;
    while (!let_go_.load()) std::this_thread::yield();  // the end of a thread releases memory: not while it is counted
  }
  std::atomic<std::uint64_t> sets_{0};
  std::atomic<bool> ended_{false}, let_go_{false};
  std::thread thread_;
};

TEST_P(IntakeAllocation, is_none_after_construction) {
  if (!AllocationCounter::kCounts) GTEST_SKIP() << "a sanitizer has replaced malloc";
  for (const std::uint32_t cameras : {1U, 3U}) {
    Intake intake(small_cameras(cameras), options());
    Consumer consumer(intake);
    for (std::uint32_t camera = 0; camera < cameras; ++camera) send(intake, camera, 1);
    EXPECT_TRUE(consumer.reaches(1)) << "the threads are up";
    AllocationCounter counter;
    for (std::uint64_t index = 2; index < 2000; ++index) disturb(intake, cameras, index);
    intake.close();
    const bool ended = consumer.ends();
    const std::uint64_t allocations = counter.disarm();
    ASSERT_TRUE(ended);
    EXPECT_EQ(allocations, 0U);
    EXPECT_GT(consumer.sets(), 1U);
    for (std::uint32_t camera = 0; camera < cameras; ++camera)
      EXPECT_EQ(consumer.sets() + lost_after_delivery(intake.losses(camera)), intake.delivered(camera));
  }
}

INSTANTIATE_TEST_SUITE_P(EveryPolicy, IntakeAllocation,
                         testing::Combine(testing::Values<HandOverPolicy>(Newest{}, Lossless{2}, Bounded{2}),
                                          testing::Values(PairBy::index, PairBy::index_and_time, PairBy::time)));

}  // namespace
}  // namespace rptv
