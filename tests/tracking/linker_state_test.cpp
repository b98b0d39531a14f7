// SPDX-License-Identifier: MIT
// What a linker knows can be asked ahead of time, kept, and taken up again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/error.hpp"
#include "tests/tracking/linking.hpp"
#include "tests/tracking/moving_points.hpp"

namespace rptv {
namespace {

const char* const kPredictors[] = {"none", "velocity", "flow", "kalman", "kalman_acceleration"};

void expect_equal(const Tracks& a, const Tracks& b) {
  EXPECT_EQ(a.particle, b.particle);
  EXPECT_EQ(a.x_mm, b.x_mm);
  EXPECT_EQ(a.vz_mm_s, b.vz_mm_s);
  EXPECT_EQ(a.age_frames, b.age_frames);
  EXPECT_EQ(a.births, b.births);
  EXPECT_EQ(a.deaths, b.deaths);
  EXPECT_EQ(a.estimate, b.estimate);
}

TEST(Snapshot, goes_on_bit_for_bit) {
  for (const char* predict : kPredictors) {
    LinkerSettings settings = settings_for(0.5, 2, predict);
    Session first(settings);
    MovingPoints points(300, MovingPoints::Steps::gauss, 0.3, 4);
    Particles particles(300);
    const auto next = [&](Session& session, std::uint64_t frame) {
      session.linker.next(particles, frame, static_cast<std::int64_t>(frame) * kPeriodNs, session.tracks);
    };
    for (std::uint64_t frame = 0; frame < 8; ++frame) {
      points.next(particles);
      if (frame % 3 == 1) particles.x_mm[7] = std::numeric_limits<double>::quiet_NaN();
      next(first, frame);
    }
    Session second(settings);
    second.linker.restore(first.linker.snapshot());
    EXPECT_EQ(second.linker.live_tracks(), first.linker.live_tracks());
    Tracks later(1000), restored_later(1000);
    first.linker.predict(9 * kPeriodNs, later);
    second.linker.predict(9 * kPeriodNs, restored_later);
    expect_equal(later, restored_later);
    for (std::uint64_t frame = 8; frame < 16; ++frame) {
      points.next(particles);
      next(first, frame + (frame > 12 ? 5 : 0));
      next(second, frame + (frame > 12 ? 5 : 0));
      expect_equal(first.tracks, second.tracks);
    }
    EXPECT_EQ(first.linker.counters().links, second.linker.counters().links);
  }
}

TEST(Snapshot, is_refused_when_it_is_not_one_and_changes_nothing) {
  Session session(settings_for(0.5, 2));
  session.next({{1, 1, 1}});
  auto bytes = session.linker.snapshot();
  Session other(settings_for(0.6, 2));
  other.next({{5, 5, 5}});
  EXPECT_THROW(other.linker.restore(bytes), Error) << "other settings";
  EXPECT_THROW(session.linker.restore(std::span(bytes).first(bytes.size() - 1)), Error);
  bytes.push_back({});
  EXPECT_THROW(session.linker.restore(bytes), Error);
  EXPECT_THROW(session.linker.restore({}), Error);
  EXPECT_THAT(session.next({{1, 1, 1}}), testing::ElementsAre(0));
  EXPECT_THAT(other.next({{5, 5, 5}}), testing::ElementsAre(0));
}

TEST(Predict, tells_where_tracks_will_be_at_any_time) {
  for (const char* predict : {"velocity", "kalman", "kalman_acceleration"}) {
    Session session(settings_for(1, 3, predict));
    for (int i = 0; i < 30; ++i) session.next({{0.1 * i, 0, 5}});
    session.next({});  // unseen: predicted all the same
    Tracks later(10);
    session.linker.predict(30 * kPeriodNs + 5 * kPeriodNs, later);
    ASSERT_EQ(later.size(), 1U);
    EXPECT_EQ(later.particle[0], 0U);
    EXPECT_NEAR(later.x_mm[0], 3.5, 0.02) << predict;
    EXPECT_NEAR(later.vx_mm_s[0], 10, 0.1) << predict;
    EXPECT_THAT(session.next({{3.1, 0, 5}}), testing::ElementsAre(0)) << "nothing has changed";
  }
}

TEST(Predict, is_less_sure_of_what_is_farther_ahead) {
  Session session(settings_for(1, 3, "kalman"));
  for (int i = 0; i < 10; ++i) session.next({{0.1 * i, 0, 5}});
  Tracks soon(10), late(10);
  session.linker.predict(10 * kPeriodNs, soon);
  session.linker.predict(20 * kPeriodNs, late);
  EXPECT_LT(soon.estimate[0].position_mm2[0], late.estimate[0].position_mm2[0]);
  EXPECT_GT(soon.estimate[0].position_mm2[0], session.tracks.estimate[0].position_mm2[0]);
  session.linker.predict(INT64_MIN, soon);  // no time: the last frame's
  session.linker.predict(INT64_MAX, soon);
  EXPECT_EQ(soon.size(), 1U);
}

TEST(Kalman, weighs_each_particle_by_its_covariance) {
  LinkerSettings settings = settings_for(2, 0, "kalman");
  settings.model_error_mm = 0.01;
  Session session(settings);
  std::vector<double> x;
  for (std::uint64_t frame = 0; frame < 20; ++frame) {
    Particles particles(2);
    const double wrong = frame % 2 == 0 ? 0.2 : -0.2;
    particles.push({wrong, 0, 0, 0, 0, {1e-6, 0, 0, 1e-6, 0, 1e-6}});
    particles.push({wrong, 10, 0, 0, 0, {0.04, 0, 0, 0.04, 0, 0.04}});
    session.linker.next(particles, frame, static_cast<std::int64_t>(frame) * kPeriodNs, session.tracks);
  }
  EXPECT_NEAR(session.tracks.x_mm[0], -0.2, 0.02) << "believed";
  EXPECT_NEAR(session.tracks.x_mm[1], 0, 0.12) << "averaged";
}

TEST(Kalman, gates_by_mahalanobis_distance) {
  LinkerSettings settings = settings_for(2, 0, "kalman");
  settings.model_error_mm = 0.05;
  settings.noise_mm = 0.05;
  for (const double gate : {0.0, 4.0}) {
    settings.gate_sigma = gate;
    Session session(settings);
    for (int i = 0; i < 20; ++i) session.next({{0.3 * i, 0, 0}});
    const auto ids = session.next({{0.3 * 20 + 1.5, 0, 0}});
    EXPECT_EQ(ids[0], gate > 0 ? 1U : 0U) << "1.5 mm off is within the range and far beyond 4 sigma";
  }
  EXPECT_THROW(
      [] {
        LinkerSettings plain = settings_for(1);
        plain.gate_sigma = 3;
        return Linker(plain);
      }(),
      Error);
}

}  // namespace
}  // namespace rptv
