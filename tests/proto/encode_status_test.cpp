// SPDX-License-Identifier: MIT
// A status goes over the wire and comes back whole; as JSON and text it says the same.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/camera_report.hpp"
#include "proto/encode.hpp"
#include "proto/text.hpp"

namespace rptv {
namespace {

TEST(Encoder, gives_back_status) {
  StatusReport report;
  report.state = RunState::running;
  report.frames_in = 12;
  report.results_out = 11;
  report.messages_sent = 10;
  report.queue_full = 2;
  report.input_hz = 99.5;
  report.output_hz = 98.5;
  report.latency[static_cast<std::size_t>(Stage::linked)] = {
      .count = 5, .p50_ns = 1, .p99_ns = 2, .p999_ns = 3, .max_ns = 4};
  report.losses = {{.place = "camera 1", .cause = LossCause::source_torn, .count = 3}};
  report.queues = {{.name = "publisher", .waiting = 1, .capacity = 8}};
  report.warnings = {"one \"warning\"\n"};
  report.cameras.resize(2);
  report.cameras[0].name = "left";
  report.cameras[0].device = {
      DeviceState::lost, "", "", "\"gone\"", 3, {{"n_missing_packets", 4}, {"n_failures", 0}}, {}, {}};
  report.cameras[1].device.last_outage = {2, 1234, 1'500'000'000, 150};
  report.cameras[1].device.readings = {77, {{"ExposureTime", 500.5}, {"Line \"2\"", 1}}};
  report.cameras[1].clock = {true, -5, 1.5, 0};
  report.cameras[1].skew = {12, 1'500, 2'500, 3'500};
  report.drift = {true, 16, 900, {{"left", 8, 640.5, 1.25, 1.5, {-1, 2, 3.5}}, {"right", 0, 0, 0, 0, {}}}};
  Encoder encoder("s", 1, 1);
  encoder.status(StatusReport{});
  WireMessage message;
  ASSERT_EQ(decode(encoder.status(report), message), "");
  const auto& got = std::get<StatusReport>(message.content);
  EXPECT_EQ(got.state, RunState::running);
  EXPECT_EQ(got.frames_in, 12U);
  EXPECT_EQ(got.results_out, 11U);
  EXPECT_EQ(got.messages_sent, 10U);
  EXPECT_EQ(got.queue_full, 2U);
  EXPECT_EQ(got.input_hz, 99.5);
  EXPECT_EQ(got.output_hz, 98.5);
  EXPECT_EQ(got.latency[static_cast<std::size_t>(Stage::linked)].p999_ns, 3);
  ASSERT_EQ(got.losses.size(), 1U);
  EXPECT_EQ(got.losses[0].place, "camera 1");
  EXPECT_EQ(got.losses[0].cause, LossCause::source_torn);
  EXPECT_EQ(got.losses[0].count, 3U);
  ASSERT_EQ(got.queues.size(), 1U);
  EXPECT_EQ(got.queues[0].capacity, 8U);
  EXPECT_EQ(got.warnings, report.warnings);
  ASSERT_EQ(got.cameras.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(to_json(got.cameras[i]), to_json(report.cameras[i]));
  EXPECT_EQ(to_json(got.cameras[0]),
            R"({"name":"left","state":"lost","device":"","link":"","problem":"\"gone\"","sessions":3,"delivered":0,)"
            R"("counters":{"n_missing_packets":4,"n_failures":0},"clock":null,"last_outage":null,"skew":null,)"
            R"("readings":null})");
  EXPECT_THAT(to_json(got.cameras[1]),
              ::testing::HasSubstr(
                  R"("clock":{"offset_ns":-5,"drift_ppm":1.5,"restarts":0},"last_outage":)"
                  R"({"number":2,"first_frame":1234,"duration_ns":1500000000,"frames_due":150},"skew":{"sets":12,)"));
  EXPECT_THAT(to_json(got.cameras[1]),
              ::testing::HasSubstr(R"("readings":{"frame":77,"values":{"ExposureTime":500.5,"Line \"2\"":1}}})"));
  EXPECT_THAT(to_line(got.cameras[1]), ::testing::HasSubstr(", ExposureTime 500.5, Line \"2\" 1"));
  EXPECT_THAT(to_line(got.cameras[1]), ::testing::HasSubstr(", gone for 1.5 s until frame 1234"));
  EXPECT_EQ(to_json(got.drift), to_json(report.drift));
  EXPECT_THAT(
      to_json(message, 0),
      ::testing::HasSubstr(R"(,"drift":{"looked_at":16,"passed_over":900,"cameras":[{"camera":"left","parts":8,)"
                           R"("votes":640.5,"median_px":1.25,"worst_px":1.5,"worst_at_mm":[-1,2,3.5]},{)"));
  EXPECT_THAT(to_line(message, 0), ::testing::HasSubstr("  disparity left 1.25 px right unknown"));
  EXPECT_EQ(to_json(DriftReport{}), "null");
  EXPECT_EQ(to_line(got.cameras[0]), "camera left lost, 0 frames, opened 3 times, n_missing_packets 4; \"gone\"");
}

}  // namespace
}  // namespace rptv
