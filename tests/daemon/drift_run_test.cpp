// SPDX-License-Identifier: MIT
// A run whose third camera was pushed says so in its status; one whose cameras stayed, or were not looked at, does not.
#include <gmock/gmock.h>

#include "daemon/live_listener.hpp"
#include "daemon/session.hpp"
#include "tests/daemon/pushed_rig.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

Config config_of(const testing::PushedRig& pushed, const std::string& rig) {
  Config config;
  config.reconstruction.kind = "multi_view";
  config.replay.path = pushed.frames();
  config.replay.rate_hz = 100, config.replay.speed = 0;
  config.intake.policy = "lossless";
  config.multi_view.rig = pushed.file(rig);
  config.multi_view.volume_x_mm = config.multi_view.volume_y_mm = config.multi_view.volume_z_mm = {-100, 100};
  config.publisher.endpoint = pushed.ipc();
  config.publisher.status_period_ms = 50;
  return config;
}

/// The last status of a recording that goes round and round until the monitor has looked.
StatusReport watch(const testing::PushedRig& pushed, const std::string& rig, const std::string& method) {
  Config config = config_of(pushed, rig);
  config.multi_view.method = method;
  config.multi_view.iterative.use_tracks = false;  // the images matter here
  config.multi_view.iterative.rounds = config.multi_view.iterative.sweeps = 1;
  config.multi_view.iterative.reduced_rounds = config.multi_view.iterative.final_sweeps = 0;
  config.intake.silence_alarm_s = 3600;  // a slow machine warns of it
  config.replay.loop = 0;
  config.replay.rate_hz = 5, config.replay.speed = 1;
  config.multi_view.drift_window_s = 0.1;
  LiveListener listener(config.publisher.endpoint);
  Session session(config);
  session.start();
  const std::int64_t deadline_ns = host_now_ns() + 300'000'000'000;
  while (listener.status().drift.cameras.empty() && host_now_ns() < deadline_ns) listener.poll(100);
  session.stop();
  return listener.status();
}

class DriftRunBy : public ::testing::TestWithParam<const char*> {};

TEST_P(DriftRunBy, warns_of_the_camera_that_was_pushed) {
  const testing::PushedRig pushed;
  const StatusReport drifted = watch(pushed, "rig.toml", GetParam());
  ASSERT_EQ(drifted.drift.cameras.size(), 4U);
  ASSERT_EQ(drifted.warnings.size(), 1U);
  EXPECT_THAT(drifted.warnings[0], HasSubstr("camera 'cam2' sees particles "));
  EXPECT_THAT(drifted.warnings[0], HasSubstr("refine FRAMES --start " + pushed.file("rig.toml")));

  const StatusReport steady = watch(pushed, "true.toml", GetParam());
  ASSERT_EQ(steady.drift.cameras.size(), 4U);
  EXPECT_THAT(steady.warnings, IsEmpty());
  for (const DisparityReport& camera : steady.drift.cameras) EXPECT_LT(camera.median_px, 0.1) << camera.camera;
}

INSTANTIATE_TEST_SUITE_P(Methods, DriftRunBy, ::testing::Values("detections", "iterative"));

TEST(DriftRun, goes_on_while_the_monitor_rests) {
  const testing::PushedRig pushed;
  Config config = config_of(pushed, "rig.toml");
  config.replay.loop = 10;
  config.multi_view.drift_window_s = 86'400;
  LiveListener listener(config.publisher.endpoint);
  Session session(config);
  session.start();
  const std::int64_t deadline_ns = host_now_ns() + 120'000'000'000;
  while (!session.finished() && host_now_ns() < deadline_ns) listener.poll(20);
  session.stop();
  while (listener.status().drift.passed_over < 19 && listener.poll(1000)) {
  }
  EXPECT_EQ(session.report().counts.linked, 20U);
  EXPECT_EQ(listener.status().drift.passed_over, 19U);
  EXPECT_THAT(session.report().losses, IsEmpty());
}

}  // namespace
}  // namespace rptv
