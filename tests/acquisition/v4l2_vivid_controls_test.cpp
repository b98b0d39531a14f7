// SPDX-License-Identifier: MIT
// Controls by name over the kernel's virtual driver. Runs in the emulated machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include "acquisition/v4l2_controls.hpp"
#include "core/descriptor.hpp"
#include "core/error.hpp"
#include "tests/acquisition/vivid_card.hpp"

namespace rptv {
namespace {

using testing::HasSubstr;

std::vector<std::string> set(const std::vector<std::string>& wishes) {
  V4l2System system;
  const Descriptor card(system.open(kCapture));
  return set_v4l2_controls(system, card.get(), kCapture, wishes);
}

std::int32_t brightness() {
  V4l2System system;
  const Descriptor card(system.open(kCapture));
  v4l2_control control{};
  control.id = V4L2_CID_BRIGHTNESS;
  EXPECT_EQ(system.call(card.get(), VIDIOC_G_CTRL, &control), 0);
  return control.value;
}

TEST(V4l2VividControls, of_every_type_are_set_and_read_back) {
  EXPECT_THAT(set({"brightness=17", "boolean=false", "integer_64_bits=-5000000000", "menu=Menu Item 4", "menu=1",
                   "integer_menu=8", "bitmask=0x80000010", "button=1", "gain_automatic=0", "gain=33"}),
              testing::IsEmpty());
  EXPECT_EQ(brightness(), 17);
}

TEST(V4l2VividControls, tell_of_one_that_an_automatic_one_governs) {
  EXPECT_THAT(set({"gain_automatic=1", "gain=33"}), testing::ElementsAre(HasSubstr("control gain has no effect")));
}

TEST(V4l2VividControls, are_refused_with_what_there_is) {
  const std::pair<const char*, const char*> cases[] = {{"brightnes=1", "it has brightness, contrast, "},
                                                       {"brightness=256", "takes 0 to 255"},
                                                       {"menu=2", "it has 1 (Menu Item 1), 3 (Menu"},
                                                       {"read_only_integer_32_bits=1", "can only be read"},
                                                       {"u16_8x16_matrix=1", "/dev/video0: has no control"}};
  for (const auto& one : cases) {
    const auto wish = [&] { set({one.first}); };
    EXPECT_THAT(wish, testing::ThrowsMessage<Error>(HasSubstr(one.second))) << one.first;
  }
}

TEST(V4l2VividControls, are_set_again_when_the_device_is_opened_again) {
  V4l2Settings settings = webcam();
  settings.controls = {"brightness=90"};
  VividSession session(settings);
  EXPECT_TRUE(session.take(1));
  EXPECT_EQ(brightness(), 90);
  press("brightness=10", kCapture);
  press("inject_fatal_streaming_error=1");
  EXPECT_TRUE(session.take_until([&] { return session.status().sessions == 2; }));
  EXPECT_EQ(brightness(), 90);
  EXPECT_EQ(session.status().problem, "");
}

TEST(V4l2VividControls, that_have_no_effect_show_in_the_status) {
  V4l2Settings settings = webcam();
  settings.controls = {"gain_automatic=1", "gain=33"};
  VividSession session(settings);
  EXPECT_TRUE(session.take(1));
  EXPECT_EQ(session.status().state, DeviceState::streaming);
  EXPECT_THAT(session.status().problem, HasSubstr("control gain has no effect"));
}

}  // namespace
}  // namespace rptv
