// SPDX-License-Identifier: MIT
// Cameras that take their images on command: by actions of somebody else, and by our own software trigger.
#include <gtest/gtest.h>

#include "core/descriptor.hpp"
#include "core/error.hpp"
#include "tests/acquisition/aravis_rig.hpp"
#include "tests/acquisition/gvsp_device.hpp"
#include "tests/acquisition/gvsp_wire.hpp"

namespace rptv {
namespace {

TEST(AravisTrigger, says_in_its_link_which_trigger_it_waits_for) {
  GvspDevice device("127.0.20.7", {});
  AravisSettings settings = settings_for("127.0.20.7");
  settings.trigger = "software";
  Rig rig(settings);
  ASSERT_TRUE(rig.take_until([&] { return rig.status().sessions == 1; })) << rig.status().problem;
  EXPECT_NE(rig.status().link.find(", trigger software"), std::string::npos) << rig.status().link;
}

/// GVCP's action command, as a timing controller sends it.
void send_action(const std::string& address, std::uint32_t device_key, std::uint32_t group_key, std::uint32_t mask) {
  std::uint8_t command[20] = {0x42, 0x00, 0x01, 0x00, 0x00, 0x0c, 0x00, 0x01};
  put32(command + 8, device_key);
  put32(command + 12, group_key);
  put32(command + 16, mask);
  const Descriptor sender(bound_socket("127.0.0.1", 0));
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(kGvcpPort);
  inet_pton(AF_INET, address.c_str(), &to.sin_addr);
  sendto(sender.get(), command, sizeof command, 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
}

TEST(AravisTrigger, takes_an_image_for_each_action_command_with_its_keys) {
  GvspDevice device("127.0.20.13", {});
  AravisSettings settings = settings_for("127.0.20.13");
  settings.trigger = "Action1";
  settings.action_device_key = 0xCAFE0001;
  settings.action_group_key = 7;
  settings.action_group_mask = 6;
  Rig rig(settings);
  ASSERT_TRUE(rig.take_until([&] { return rig.status().state == DeviceState::streaming; })) << rig.status().problem;
  for (std::uint64_t image = 1; image <= 5; ++image) {
    send_action("127.0.20.13", 0xCAFE0002, 7, 2);
    send_action("127.0.20.13", 0xCAFE0001, 8, 2);
    send_action("127.0.20.13", 0xCAFE0001, 7, 1);
    send_action("127.0.20.13", 0xCAFE0001, 7, 2);
    EXPECT_TRUE(rig.take_until([&] { return rig.received().newest == image; })) << image;
  }
  EXPECT_EQ(device.truth().sent, 5U);
}

std::uint64_t counter(const DeviceStatus& status, const std::string& name) {
  for (const DeviceCounter& one : status.counters)
    if (one.name == name) return one.count;
  ADD_FAILURE() << "no counter " << name;
  return 0;
}

TEST(AravisTrigger, fires_a_camera_by_software_once_a_period) {
  GvspDevice device("127.0.20.15", {});
  AravisSettings settings = settings_for("127.0.20.15");
  settings.trigger = "software";
  settings.rate_hz = 50;
  Rig rig(settings);
  const std::int64_t start_ns = host_now_ns();
  ASSERT_TRUE(rig.take_until([&] { return rig.received().images >= 30; })) << rig.status().problem;
  const std::int64_t took_ns = host_now_ns() - start_ns;
  device.rest();
  EXPECT_TRUE(rig.settles_at(device.truth().sent)) << rig.accounted() << " of " << device.truth().sent;
  EXPECT_EQ(rig.received().wrong, 0U);
  // A command counts when its answer is back, and its image may be faster.
  EXPECT_TRUE(rig.take_until([&] { return counter(rig.status(), "triggers_fired") >= device.truth().sent; }))
      << "an image without a command";
  const std::uint64_t skipped = counter(rig.status(), "triggers_skipped");
  EXPECT_GE(took_ns, (30 + static_cast<std::int64_t>(skipped) - 1) * 20'000'000) << "one for each period";
}

// Their own clocks are the host's, so the times of a set are those at which each was fired. At any other distance than
// nearly none there would be no sets.
TEST(AravisTrigger, fires_all_cameras_together) {
  const GvspDevice left("127.0.20.16", {}), right("127.0.20.17", {});
  AravisSettings settings = settings_for("127.0.20.16");
  settings.cameras.push_back("127.0.20.17");
  settings.trigger = "software";
  settings.rate_hz = 5;
  AravisSource source(settings, 16);
  IntakeOptions options{Bounded{8}, 16, 4};
  options.pairing = {PairBy::index_and_time, false, 20'000'000};
  Intake intake(source.cameras(), options);
  source.start(intake);
  const std::int64_t deadline_ns = host_now_ns() + kPatience_ns;
  FrameSet set;
  std::uint64_t sets = 0, prompt = 0;
  while (sets < 10 && host_now_ns() < deadline_ns) {
    if (intake.next(set, 50'000'000) != Taken::value) continue;
    ++sets;
    prompt += set.frames[0].info.exposure_end_ns % 200'000'000 < 50'000'000;
  }
  set.reset();
  intake.close();
  source.stop();
  EXPECT_EQ(sets, 10U);
  EXPECT_GE(prompt, 8U) << "at the multiples of the period";
}

TEST(AravisTrigger, wants_to_know_how_often_to_fire) {
  AravisSettings settings = settings_for("127.0.20.18");
  settings.trigger = "software";
  settings.rate_hz = 0;
  try {
    const AravisSource source(settings, 8);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::configuration);
    EXPECT_NE(std::string(error.what()).find("set rate_hz"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace rptv
