// SPDX-License-Identifier: MIT
// The whole daemon on a live camera: frames over GigE Vision on loopback, tracks and the camera's state over ZeroMQ.
#include <gtest/gtest.h>

#include "daemon/live_listener.hpp"
#include "daemon/session.hpp"
#include "tests/acquisition/gvsp_device.hpp"
#include "tests/daemon/small_run.hpp"

namespace rptv {
namespace {

TEST(CameraSession, publishes_what_a_live_camera_sees_and_how_the_camera_fares) {
  const testing::SmallRun run(2);
  Config config = run.config();
  config.source.kind = "aravis";
  config.aravis.cameras = {"127.0.0.9"};
  config.aravis.region = {0, 0, 256, 256};
  config.aravis.rate_hz = 50;
  config.aravis.packet_size = 1400;
  config.light_field.background_image.clear();
  config.light_field.threshold = 250;  // the device's images are noise
  config.intake.policy = "bounded";
  config.publisher.status_period_ms = 100;
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

}  // namespace
}  // namespace rptv
