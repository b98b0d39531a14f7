// SPDX-License-Identifier: MIT
// Faults come as often as asked, the same in every run, and never so that cameras wait for each other.
#include "replay/fault_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/replay/image_maker.hpp"

namespace rptv::testing {
namespace {

constexpr std::uint64_t kSteps = 100'000;

template <class Condition>
double share(Condition condition) {
  std::uint64_t hits = 0;
  for (std::uint64_t step = 0; step < kSteps; ++step) hits += condition(step) ? 1 : 0;
  return static_cast<double>(hits) / static_cast<double>(kSteps);
}

TEST(FaultPlan, gives_the_fractions_that_were_asked_for) {
  ReplayFaults faults;
  faults.drop_fraction = 0.1;
  faults.duplicate_fraction = 0.05;
  faults.torn_fraction = 0.02;
  faults.bunch_fraction = 0.3;
  faults.clock_jump_fraction = 0.01;
  faults.reorder_fraction = 0.2;
  const FaultPlan plan(faults);
  // four standard deviations of a binomial draw of 10^5
  EXPECT_NEAR(share([&](auto s) { return plan.frame_fault(s, 1) == FrameFault::drop; }), 0.1, 0.004);
  EXPECT_NEAR(share([&](auto s) { return plan.frame_fault(s, 1) == FrameFault::duplicate; }), 0.05, 0.003);
  EXPECT_NEAR(share([&](auto s) { return plan.frame_fault(s, 1) == FrameFault::torn; }), 0.02, 0.002);
  EXPECT_NEAR(share([&](auto s) { return plan.waits_for_next(s, 1); }), 0.3, 0.006);
  EXPECT_NEAR(share([&](auto s) { return plan.clock_jumps(s, 1); }), 0.01, 0.0015);
  EXPECT_NEAR(share([&](auto s) { return plan.is_late(s, 0, 2) || plan.is_late(s, 1, 2); }), 0.2, 0.006);
}

TEST(FaultPlan, is_clean_by_default) {
  const FaultPlan plan{ReplayFaults{}};
  EXPECT_EQ(share([&](auto s) {
              return plan.frame_fault(s, 0) != FrameFault::none || plan.waits_for_next(s, 0) ||
                     plan.clock_jumps(s, 0) || plan.is_late(s, 0, 4);
            }),
            0);
}

TEST(FaultPlan, depends_on_seed_step_and_camera_only) {
  ReplayFaults faults;
  faults.drop_fraction = 0.5;
  const FaultPlan plan(faults);
  const FaultPlan again(faults);
  faults.seed = 2;
  const FaultPlan other(faults);
  EXPECT_EQ(share([&](auto s) { return plan.frame_fault(s, 3) != again.frame_fault(s, 3); }), 0);
  EXPECT_NEAR(share([&](auto s) { return plan.frame_fault(s, 3) != other.frame_fault(s, 3); }), 0.5, 0.01);
  EXPECT_NEAR(share([&](auto s) { return plan.frame_fault(s, 3) != plan.frame_fault(s, 2); }), 0.5, 0.01);
}

TEST(FaultPlan, never_makes_two_cameras_wait_for_each_other) {
  ReplayFaults faults;
  faults.reorder_fraction = 0.5;
  const FaultPlan plan(faults);
  const auto late = [&](std::uint64_t step) {
    int cameras = 0;
    for (std::uint32_t camera = 0; camera < 4; ++camera) cameras += plan.is_late(step, camera, 4) ? 1 : 0;
    return cameras;
  };
  for (std::uint64_t step = 0; step < 1000; ++step) {
    EXPECT_LE(late(step), 1);
    EXPECT_FALSE(late(step) > 0 && late(step + 1) > 0);
    EXPECT_FALSE(plan.is_late(step, 0, 1));
  }
}

TEST(FaultPlan, makes_no_bunch_longer_than_the_longest) {
  ReplayFaults faults;
  faults.bunch_fraction = 1;
  const FaultPlan plan(faults);
  std::uint64_t run = 0;
  for (std::uint64_t step = 0; step < 1000; ++step) {
    run = plan.waits_for_next(step, 0) ? run + 1 : 0;
    EXPECT_LT(run, FaultPlan::kLongestBunch);
  }
}

TEST(FaultPlan, refuses_more_than_one_fault_per_frame) {
  ReplayFaults faults;
  faults.drop_fraction = 0.7;
  faults.torn_fraction = 0.6;
  const auto [code, text] = error_of([&] { FaultPlan{faults}; });
  EXPECT_EQ(code, ExitCode::configuration);
  EXPECT_THAT(text, ::testing::HasSubstr("1.3"));
}

}  // namespace
}  // namespace rptv::testing
