// SPDX-License-Identifier: MIT
// A video signal that changes its size, or goes away, at the virtual card's HDMI input. Runs in the emulated machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "tests/acquisition/vivid_card.hpp"

namespace rptv {
namespace {

using testing::HasSubstr;

class V4l2VividSignal : public testing::Test {
 protected:
  ~V4l2VividSignal() override { press("dv_timings_signal_mode=current_dv_timings", kCapture); }

  static V4l2Settings hdmi(std::int64_t width_px, std::int64_t height_px) {
    V4l2Settings settings = webcam();
    settings.width_px = width_px, settings.height_px = height_px, settings.rate_hz = 0;
    return settings;
  }
  static void send(const std::string& timings) {
    press("dv_timings_signal_mode=selected_dv_timings", kCapture);
    press("dv_timings=" + timings, kCapture);
  }
  static bool wait_for_problem(VividSession& session, const std::string& words) {
    return VividSession::wait_for([&] { return session.status().problem.find(words) != std::string::npos; });
  }
  const HdmiInput input_;
};

TEST_F(V4l2VividSignal, of_another_size_is_scaled_by_the_card_and_goes_on) {
  VividSession session(hdmi(640, 480));
  EXPECT_TRUE(session.take(2));
  send("800x600p60");
  EXPECT_TRUE(session.take_until([&] { return session.status().sessions >= 2; }));
  EXPECT_TRUE(session.take(2));
  EXPECT_GE(session.counter("source_changes"), 1U);
  EXPECT_EQ(session.counter("device_lost"), 0U);
}

TEST_F(V4l2VividSignal, of_another_size_that_fits_no_slot_is_told_until_it_is_back) {
  VividSession session(hdmi(0, 0));
  EXPECT_TRUE(session.take(2));
  send("800x600p60");
  EXPECT_TRUE(wait_for_problem(session, "came back with 800 x 600 px where 640 x 480 px were"));
  EXPECT_EQ(session.status().state, DeviceState::lost);
  send("640x480p59");
  EXPECT_TRUE(session.take_until([&] { return session.status().state == DeviceState::streaming; }));
  EXPECT_TRUE(session.take(2));
  EXPECT_EQ(session.status().problem, "");
}

TEST_F(V4l2VividSignal, of_a_mode_that_the_card_does_not_take_is_refused) {
  send("720x576i25");
  EXPECT_THAT([] { V4l2Source source(hdmi(0, 0), 16); },
              testing::ThrowsMessage<Error>(HasSubstr("/dev/video0: has a signal that it cannot take")));
}

TEST_F(V4l2VividSignal, that_is_not_there_is_told_until_it_comes) {
  press("dv_timings_signal_mode=no_signal", kCapture);
  EXPECT_THAT([] { V4l2Source source(hdmi(0, 0), 16); },
              testing::ThrowsMessage<Error>(HasSubstr("/dev/video0: has no stable signal at its input")));
  press("dv_timings_signal_mode=out_of_range", kCapture);
  EXPECT_THAT([] { V4l2Source source(hdmi(0, 0), 16); },
              testing::ThrowsMessage<Error>(HasSubstr("has a signal that it cannot take")));
  press("dv_timings_signal_mode=current_dv_timings", kCapture);
  VividSession session(hdmi(0, 0));
  EXPECT_TRUE(session.take(2));
  press("dv_timings_signal_mode=no_lock", kCapture);
  EXPECT_TRUE(wait_for_problem(session, "has no stable signal"));
  press("dv_timings_signal_mode=current_dv_timings", kCapture);
  EXPECT_TRUE(session.take_until([&] { return session.status().state == DeviceState::streaming; }));
  EXPECT_TRUE(session.take(2));
}

}  // namespace
}  // namespace rptv
