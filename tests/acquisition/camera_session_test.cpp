// SPDX-License-Identifier: MIT
// The whole daemon on a live camera: frames over GigE Vision on loopback, tracks and the camera's state over ZeroMQ.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "daemon/live_listener.hpp"
#include "daemon/session.hpp"
#include "tests/acquisition/gvsp_device.hpp"
#include "tests/daemon/small_run.hpp"

namespace rptv {
namespace {

Config config_of(const testing::SmallRun& run, const std::vector<std::string>& addresses) {
  Config config = run.config();
  config.source.kind = "aravis";
  config.aravis.cameras = addresses;
  config.aravis.region = {0, 0, 256, 256};
  config.aravis.rate_hz = 50;
  config.aravis.packet_size = 1400;
  config.intake.policy = "bounded";
  config.publisher.status_period_ms = 100;
  return config;
}

TEST(CameraSession, publishes_what_a_live_camera_sees_and_how_the_camera_fares) {
  const testing::SmallRun run(2);
  Config config = config_of(run, {"127.0.0.9"});
  config.light_field.background_image.clear();
  config.light_field.threshold = 250;  // the device's images are noise
  GvspDevice device("127.0.0.9", {});
  LiveListener listener(config.publisher.endpoint);
  Session session(config);
  session.start();
  const std::int64_t deadline_ns = host_now_ns() + 60'000'000'000;
  const auto told = [&] {
    const auto& cameras = listener.status().cameras;
    return cameras.size() == 1 && cameras[0].delivered >= 40;
  };
  while ((listener.frames() < 30 || !told()) && host_now_ns() < deadline_ns) listener.poll(100);
  session.stop();
  ASSERT_GE(listener.frames(), 30U);
  ASSERT_TRUE(told());
  const CameraReport& camera = listener.status().cameras[0];
  EXPECT_EQ(camera.name, "127.0.0.9");
  EXPECT_EQ(camera.device.state, DeviceState::streaming);
  EXPECT_EQ(camera.device.sessions, 1U);
  EXPECT_TRUE(camera.clock.valid);
  const SessionReport report = session.report();
  ASSERT_EQ(report.cameras.size(), 1U);
  // Every frame that the camera gave was linked, or is counted as lost.
  std::uint64_t lost = 0;
  for (const LossCount& loss : report.losses) lost += loss.place == "readers" ? 0 : loss.count;
  EXPECT_GE(report.counts.linked + lost, report.cameras[0].delivered);
  EXPECT_NE(to_text(report).find("camera 127.0.0.9 streaming"), std::string::npos);
  EXPECT_NE(to_json(report).find(R"("cameras":[{"name":"127.0.0.9","state":"streaming")"), std::string::npos);
}

/// Sets of several cameras have no reconstruction yet: finds nothing in them.
class NoParticles final : public Reconstructor {
 public:
  void reconstruct(const FrameSet&, Particles& out) noexcept override { out.clear(); }
};

struct Told {
  StatusReport status;  ///< the last one
  std::string report;
};

/// A run of two free-running cameras, until a status has told of so many sets.
Told run_two(const std::string& mode, std::uint64_t sets) {
  const testing::SmallRun run(2);
  Config config = config_of(run, {"127.0.0.9", "127.0.0.10"});
  config.sync.mode = mode;
  config.sync.tolerance_us = 9900;
  const GvspDevice left("127.0.0.9", {}), right("127.0.0.10", {});
  LiveListener listener(config.publisher.endpoint);
  Session session(config, make_source(config), std::make_unique<NoParticles>());
  session.start();
  const std::int64_t deadline_ns = host_now_ns() + 60'000'000'000;
  const auto told = [&] {
    const auto& cameras = listener.status().cameras;
    return cameras.size() == 2 && cameras[1].skew.sets >= sets;
  };
  while (!told() && host_now_ns() < deadline_ns) listener.poll(100);
  session.stop();
  EXPECT_TRUE(told());
  return {listener.status(), to_text(session.report())};
}

TEST(CameraSession, pairs_free_running_cameras_by_time_and_says_how_far_they_are_apart) {
  const auto [status, report] = run_two("device", 20);
  ASSERT_EQ(status.cameras.size(), 2U);
  EXPECT_EQ(status.cameras[0].skew.max_ns, 0);
  EXPECT_LE(status.cameras[1].skew.max_ns, 9'900'000);
  EXPECT_THAT(status.warnings, ::testing::Not(::testing::Contains(::testing::HasSubstr("sync.mode"))));
  EXPECT_THAT(report, ::testing::HasSubstr(", skew P50 "));
}

TEST(CameraSession, warns_in_every_status_of_sets_that_nothing_checks) {
  EXPECT_THAT(run_two("none", 0).status.warnings, ::testing::Contains(::testing::HasSubstr("sync.mode = 'none'")));
}

TEST(CameraSession, does_not_start_with_several_cameras_until_it_is_told_what_keeps_them_in_step) {
  const testing::SmallRun run(2);
  const Config config = config_of(run, {"127.0.0.9", "127.0.0.10"});
  const GvspDevice left("127.0.0.9", {}), right("127.0.0.10", {});
  try {
    const Session session(config, make_source(config), std::make_unique<NoParticles>());
    ADD_FAILURE() << "started";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::configuration);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("sync.mode is unset"));
  }
}

}  // namespace
}  // namespace rptv
