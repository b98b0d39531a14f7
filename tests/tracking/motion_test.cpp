// SPDX-License-Identifier: MIT
// What new tracks start with, and what the flow as a whole tells.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "tests/tracking/linking.hpp"
#include "tracking/flow_field.hpp"

namespace rptv {
namespace {

using testing::ElementsAre;

TEST(StartUp, expects_a_new_track_to_move_like_its_neighbour) {
  for (const char* start_up : {"nearest", "rest"}) {
    LinkerSettings settings = settings_for(0.5, 0, "velocity");
    settings.start_up = start_up;
    Session session(settings);
    session.next({{0, 0, 0}, {0, 9, 0}});
    session.next({{0.4, 0, 0}, {-0.4, 9, 0}});
    session.next({{1.2, 0, 0}, {-0.4, 9, 0}, {5, 1, 0}});  // 0.8 a frame; a new one comes near it
    EXPECT_EQ(session.tracks.vx_mm_s[2], 0) << "not known yet, only expected";
    const auto ids = session.next({{2.0, 0, 0}, {-0.4, 9, 0}, {5.8, 1, 0}});
    EXPECT_THAT(ids, ElementsAre(0, 1, std::string(start_up) == "nearest" ? 2 : 3));
  }
}

TEST(StartUp, takes_a_known_flow_from_the_first_frame_on) {
  for (const char* predict : {"velocity", "flow", "kalman", "kalman_acceleration"}) {
    Session session(settings_for(0.2, 0, predict));
    const std::vector<VelocitySample> flow{{0, 0, 0, 300, 0, 0}, {0, 4, 0, -300, 0, 0}};
    session.linker.seed(flow);
    session.next({{0, 0.1, 0}, {0, 3.9, 0}});
    EXPECT_THAT(session.next({{3, 0.1, 0}, {-3, 3.9, 0}}), ElementsAre(0, 1)) << predict;
    EXPECT_THAT(session.next({{6, 0.1, 0}, {-6, 3.9, 0}}), ElementsAre(0, 1)) << predict;
  }
  Session session(settings_for(1));
  const std::vector<VelocitySample> wrong{{0, 0, 0, std::numeric_limits<double>::infinity(), 0, 0}};
  EXPECT_THROW(session.linker.seed(wrong), Error);
}

TEST(FlowField, gives_the_mean_of_what_was_seen_near) {
  FlowField field(1.0, 64);
  VelocitySample at{0.5, 0.5, 0.5};
  EXPECT_FALSE(field.look_up(at));
  for (int i = 0; i < 3; ++i) field.add({0.2, 0.7, 0.9, 10.0 * i, 5, -1});
  ASSERT_TRUE(field.look_up(at));
  EXPECT_NEAR(at.vx_mm_s, 10, 1e-12);
  EXPECT_EQ(at.vy_mm_s, 5);
  at = {-0.5, 0.5, 0.5};
  EXPECT_FALSE(field.look_up(at)) << "another cube";
}

TEST(FlowField, forgets_what_is_long_ago) {
  FlowField field(1.0, 64);
  for (int i = 0; i < 1000; ++i) field.add({0, 0, 0, 100, 0, 0});
  for (int i = 0; i < 1000; ++i) field.add({0, 0, 0, -50, 0, 0});
  VelocitySample at{};
  ASSERT_TRUE(field.look_up(at));
  EXPECT_NEAR(at.vx_mm_s, -50, 1e-3);
}

TEST(FlowField, keeps_working_when_it_is_full_and_for_any_position) {
  FlowField field(1e-3, 16);
  for (int i = 0; i < 10'000; ++i) field.add({0.01 * i, -1e300, 1e300, 1, 1, 1});
  VelocitySample at{1e300, 0, -1e300};
  field.look_up(at);
  EXPECT_EQ(field.bins().size(), 16U);
}

}  // namespace
}  // namespace rptv
