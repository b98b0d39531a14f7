// SPDX-License-Identifier: MIT
// Velocities come from the camera's clock, and survive its faults.
#include <gtest/gtest.h>

#include <cstdint>

#include "tests/tracking/linking.hpp"

namespace rptv {
namespace {

TEST(Velocity, is_zero_in_the_first_frame_and_the_finite_difference_after) {
  Session session(settings_for(1.0));
  session.next({{1, 2, 3}}, 0, 5'000'000'000);
  EXPECT_EQ(session.tracks.vx_mm_s[0], 0);
  session.next({{1.1, 1.8, 3.3}}, 1, 5'020'000'000);
  EXPECT_NEAR(session.tracks.vx_mm_s[0], 5, 1e-9);
  EXPECT_NEAR(session.tracks.vy_mm_s[0], -10, 1e-9);
  EXPECT_NEAR(session.tracks.vz_mm_s[0], 15, 1e-9);
}

TEST(Velocity, counts_the_whole_time_since_a_particle_was_seen) {
  Session session(settings_for(1.0, 3));
  session.next({{0, 0, 0}}, 0, 0);
  session.next({}, 1, 10'000'000);
  session.next({{0.3, 0, 0}}, 2, 30'000'000);
  EXPECT_NEAR(session.tracks.vx_mm_s[0], 10, 1e-9);
}

TEST(Velocity, is_kept_when_the_clock_stands_still_or_goes_back) {
  for (const std::int64_t fault_ns : {10'000'000LL, 0LL, -9'000'000'000LL, static_cast<long long>(INT64_MIN)}) {
    Session session(settings_for(1.0));
    session.next({{0, 0, 0}}, 0, 0);
    session.next({{0.1, 0, 0}}, 1, 10'000'000);
    session.next({{0.3, 0, 0}}, 2, fault_ns);
    EXPECT_NEAR(session.tracks.vx_mm_s[0], 10, 1e-9);
    EXPECT_EQ(session.linker.counters().clock_faults, 1U);
    if (fault_ns == INT64_MIN) continue;
    session.next({{0.5, 0, 0}}, 3, fault_ns + 10'000'000);
    EXPECT_NEAR(session.tracks.vx_mm_s[0], 20, 1e-9) << "measured again from the next step on";
    EXPECT_EQ(session.linker.counters().clock_faults, 1U);
  }
}

TEST(Velocity, is_kept_over_a_jump_of_the_clock) {
  Session session(settings_for(1.0, 0, "velocity"));
  constexpr std::int64_t kEpochNs = 1'790'000'000'000'000'000;
  session.next({{0, 0, 0}}, 0, 0);
  session.next({{0.1, 0, 0}}, 1, 10'000'000);
  EXPECT_EQ(session.next({{0.2, 0, 0}}, 2, kEpochNs), std::vector<std::uint64_t>{0}) << "predicted one period on";
  EXPECT_NEAR(session.tracks.vx_mm_s[0], 10, 1e-9);
  session.next({{0.3, 0, 0}}, 3, kEpochNs + 10'000'000);
  EXPECT_NEAR(session.tracks.vx_mm_s[0], 10, 1e-6);
  EXPECT_EQ(session.linker.counters().clock_faults, 1U);
}

TEST(Velocity, believes_a_pause_of_the_trigger) {
  Session session(settings_for(1.0));
  session.next({{0, 0, 0}}, 0, 0);
  session.next({{0.1, 0, 0}}, 1, 10'000'000);
  session.next({{0.6, 0, 0}}, 2, 1'010'000'000);
  EXPECT_NEAR(session.tracks.vx_mm_s[0], 0.5, 1e-9);
  EXPECT_EQ(session.linker.counters().clock_faults, 0U);
}

TEST(Velocity, needs_no_first_step_to_meet_a_fault) {
  Session session(settings_for(1.0, 0, "velocity"));
  session.next({{0, 0, 0}}, 0, 0);
  session.next({{0.1, 0, 0}}, 1, 0);
  EXPECT_EQ(session.tracks.particle[0], 0U);
  EXPECT_EQ(session.tracks.vx_mm_s[0], 0);
}

TEST(FrameIndex, that_does_not_increase_counts_as_one_frame) {
  Session session(settings_for(1.0, 1));
  session.next({{0, 0, 0}}, 5, 0);
  EXPECT_EQ(session.next({{0, 0, 0}}, 5, 10'000'000), std::vector<std::uint64_t>{0});
  EXPECT_EQ(session.next({{0, 0, 0}}, 0, 20'000'000), std::vector<std::uint64_t>{0});
  EXPECT_EQ(session.linker.counters().frame_faults, 2U);
  EXPECT_EQ(session.next({{0, 0, 0}}, 1, 30'000'000), std::vector<std::uint64_t>{0});
  EXPECT_EQ(session.next({{0, 0, 0}}, UINT64_MAX, 40'000'000), std::vector<std::uint64_t>{1});
}

}  // namespace
}  // namespace rptv
