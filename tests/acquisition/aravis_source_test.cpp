// SPDX-License-Identifier: MIT
// Cameras over real GigE Vision on loopback: every byte checked, every loss accounted, and back after a restart.
#include <gtest/gtest.h>

#include <memory>

#include "core/error.hpp"
#include "tests/acquisition/aravis_rig.hpp"
#include "tests/acquisition/gvsp_device.hpp"
#include "tests/acquisition/gvsp_registers.hpp"

namespace rptv {
namespace {

class AravisSourceFormats : public testing::TestWithParam<const char*> {};

TEST_P(AravisSourceFormats, gives_every_byte_that_the_camera_sent) {
  GvspDevice device("127.0.20.1", {});
  AravisSettings settings = settings_for("127.0.20.1");
  settings.pixel_format = GetParam();
  Rig rig(settings);
  ASSERT_TRUE(rig.take_until([&] { return rig.received().images >= 50; })) << rig.status().problem;
  EXPECT_EQ(rig.status().sessions, 1U);
  device.rest();
  EXPECT_TRUE(rig.settles_at(device.truth().sent)) << rig.accounted() << " of " << device.truth().sent;
  EXPECT_EQ(rig.received().wrong, 0U);
}

INSTANTIATE_TEST_SUITE_P(Mono, AravisSourceFormats,
                         testing::Values("Mono8", "Mono16", "Mono10p", "Mono12p", "Mono12Packed"));

TEST(AravisSource, tells_what_the_camera_writes_behind_its_images) {
  for (const char* format : {"Mono8", "Mono12p"}) {
    GvspDevice device("127.0.20.11", {});
    AravisSettings settings = settings_for("127.0.20.11");
    settings.pixel_format = format;
    settings.chunks = {"ExposureTime", "FrameID"};
    Rig rig(settings);
    const auto readings = [&] { return rig.status().readings; };
    ASSERT_TRUE(rig.take_until([&] { return rig.received().images >= 20 && readings().frame > 0; }));
    const std::uint64_t first = rig.received().first_index, number = rig.received().first;
    ASSERT_TRUE(rig.take_until([&] { return readings().frame > first; })) << "they are read again";
    const DeviceReadings now = readings();
    ASSERT_EQ(now.values.size(), 2U);
    EXPECT_EQ(now.values[0], (DeviceReadings::Value{"ExposureTime", kExposureInChunk_us}));
    EXPECT_EQ(now.values[1].name, "FrameID");
    EXPECT_EQ(now.values[1].value, static_cast<double>(number + now.frame - first)) << "of that very image";
    device.rest();
    EXPECT_TRUE(rig.settles_at(device.truth().sent)) << rig.accounted() << " of " << device.truth().sent;
    EXPECT_EQ(rig.received().wrong, 0U);
  }
}

TEST(AravisSource, names_a_chunk_that_the_camera_has_not) {
  GvspDevice device("127.0.20.12", {});
  AravisSettings settings = settings_for("127.0.20.12");
  settings.chunks = {"Encoder"};
  try {
    AravisSource source(settings, 8);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("chunks = Encoder"), std::string::npos) << error.what();
  }
}

TEST(AravisSource, loses_no_image_uncounted_when_packets_are_lost_doubled_and_swapped) {
  for (const bool answers : {true, false}) {
    GvspDevice device("127.0.20.2", {0.02, 0.02, 0.02, answers, 65400, 7});
    AravisSettings settings = settings_for("127.0.20.2");
    settings.packet_resend = answers;
    Rig rig(settings);
    ASSERT_TRUE(rig.take_until([&] { return rig.received().newest >= 250; })) << rig.status().problem;
    device.rest();
    EXPECT_TRUE(rig.settles_at(device.truth().sent)) << rig.accounted() << " of " << device.truth().sent;
    EXPECT_EQ(rig.received().wrong, 0U);
    EXPECT_EQ(rig.received().newest_index - rig.received().first_index, rig.received().newest - rig.received().first)
        << "indices go through the wrap";
    EXPECT_GT(answers ? device.truth().resent.load() : rig.lost(), 0U) << "the faults reached us";
  }
}

TEST(AravisSource, counts_what_was_lost_before_the_first_image_that_came) {
  GvspFaults faults;
  faults.lost_at_start = 3;
  GvspDevice device("127.0.20.13", faults);
  Rig rig(settings_for("127.0.20.13"));
  ASSERT_TRUE(rig.take_until([&] { return rig.received().images >= 5; })) << rig.status().problem;
  EXPECT_EQ(rig.received().first, 4U);
  device.rest();
  EXPECT_TRUE(rig.settles_at(device.truth().sent)) << rig.accounted() << " of " << device.truth().sent;
  EXPECT_EQ(rig.lost(), 3U);
}

TEST(AravisSource, counts_nothing_before_the_first_image_of_a_camera_that_counts_on_from_an_earlier_stream) {
  GvspFaults faults;
  faults.first_id = 5000;
  GvspDevice device("127.0.20.14", faults);
  Rig rig(settings_for("127.0.20.14"));
  ASSERT_TRUE(rig.take_until([&] { return rig.received().images >= 5; })) << rig.status().problem;
  device.rest();
  EXPECT_TRUE(rig.settles_at(device.truth().sent)) << rig.accounted() << " of " << device.truth().sent;
  EXPECT_EQ(rig.lost(), 0U);
}

TEST(AravisSource, gives_every_image_at_once_although_packets_come_that_belong_to_none) {
  GvspFaults faults;
  faults.strays = 0.2;
  GvspDevice device("127.0.20.10", faults);
  Rig rig(settings_for("127.0.20.10"));
  ASSERT_TRUE(rig.take_until([&] { return rig.received().newest >= 50; })) << rig.status().problem;
  device.rest();
  EXPECT_TRUE(rig.take_until([&] { return rig.received().newest == device.truth().sent; })) << "none is held back";
  EXPECT_EQ(rig.lost(), 0U);
  EXPECT_EQ(rig.received().wrong, 0U);
}

TEST(AravisSource, goes_on_when_the_camera_was_restarted) {
  constexpr std::uint64_t kLives = 6;
  const auto begin = [](std::uint64_t life) {
    return std::make_unique<GvspDevice>("127.0.20.3", GvspFaults{}, GvspIdentity{"SIM1", life << 32});
  };
  auto device = begin(1);
  Rig rig(settings_for("127.0.20.3"));
  for (std::uint64_t life = 1; life <= kLives; ++life) {
    const std::uint64_t before = rig.received().images;
    ASSERT_TRUE(rig.take_until([&] { return rig.status().sessions >= life && rig.received().images >= before + 10; }))
        << rig.status().problem;
    device->rest();
    rig.lives().over(life, device->truth());
    if (life == kLives) break;
    device.reset();
    device = begin(life + 1);
  }
  const std::uint64_t last_image = kLives << 32 | device->truth().sent;
  rig.take_until([&] { return rig.accounted() >= rig.lives().least() || rig.received().newest == last_image; });
  EXPECT_TRUE(rig.lives().explain(rig.accounted(), rig.estimated()))
      << rig.accounted() << " of " << rig.lives().least();
  EXPECT_EQ(rig.received().wrong, 0U) << "no image comes twice, and indices grow";
}

TEST(AravisSource, says_in_its_link_how_packets_reach_it_and_what_the_kernel_granted) {
  GvspDevice device("127.0.20.8", {});
  AravisSettings settings = settings_for("127.0.20.8");
  settings.packet_socket = false;
  settings.packet_resend = false;
  settings.socket_buffer_bytes = 100'000;
  Rig rig(settings);
  ASSERT_TRUE(rig.take_until([&] { return rig.received().images >= 20; })) << rig.status().problem;
  EXPECT_EQ(
      rig.status().link,
      "Mono8 128 x 96 px, exposure 10000 us, packets of 1400 bytes, socket buffer 100000 of 100000 bytes, resend off");
}

TEST(AravisSource, sets_the_camera_clock_by_ptp_and_reports_its_offset) {
  GvspDevice device("127.0.20.11", {});
  AravisSettings settings = settings_for("127.0.20.11");
  settings.ptp = true;
  Rig rig(settings);
  ASSERT_TRUE(rig.take_until([&] { return rig.received().images >= 20; })) << rig.status().problem;
  EXPECT_EQ(rig.received().clock, ClockId::ptp);
  EXPECT_NE(rig.status().link.find(", PTP Slave, offset -120 ns"), std::string::npos) << rig.status().link;
}

TEST(AravisSource, says_that_no_ptp_master_answers) {
  GvspFaults faults;
  faults.ptp_has_master = false;
  GvspDevice device("127.0.20.12", faults);
  AravisSettings settings = settings_for("127.0.20.12");
  settings.ptp = true;
  settings.ptp_wait_s = 1;
  Rig rig(settings);
  EXPECT_TRUE(rig.take_until([&] {
    return rig.status().problem.find("its state is 'Listening'") != std::string::npos;
  })) << rig.status().problem;
  EXPECT_EQ(rig.received().images, 0U);
}

TEST(AravisSource, streams_from_two_cameras_at_once) {
  GvspDevice left("127.0.20.5", {}), right("127.0.20.6", {});
  AravisSettings settings = settings_for("127.0.20.5");
  settings.cameras.push_back("127.0.20.6");
  Rig rig(settings);
  const auto delivered = [&](std::size_t camera) { return rig.status(camera).counters.at(0).count; };
  ASSERT_TRUE(rig.take_until([&] { return delivered(0) >= 50 && delivered(1) >= 50; }))
      << delivered(0) << " and " << delivered(1) << "; " << rig.status(0).problem << rig.status(1).problem;
  EXPECT_EQ(rig.received().wrong, 0U);
}

/// Aravis' own simulator, which knows who controls it; our device lets anybody.
struct StockCamera {
  ArvGvFakeCamera* camera = arv_gv_fake_camera_new("127.0.0.1", "RP43");
  ~StockCamera() { g_object_unref(camera); }
};

TEST(AravisSource, says_that_another_program_has_the_camera_and_takes_it_when_it_is_free) {
  const StockCamera stock;
  ASSERT_TRUE(arv_gv_fake_camera_is_running(stock.camera));
  AravisSettings settings = settings_for("127.0.0.1");
  ArvCamera* other = arv_camera_new("127.0.0.1", nullptr);
  ASSERT_NE(other, nullptr);
  try {
    AravisSource source(settings, 16);
    ADD_FAILURE() << "two programs control one camera";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::unavailable);
    EXPECT_NE(std::string(error.what()).find("another program"), std::string::npos) << error.what();
  }
  g_object_unref(other);
  Rig rig(settings);
  ASSERT_TRUE(rig.take_until([&] { return rig.received().images >= 20; })) << rig.status().problem;
}

TEST(AravisSource, names_an_absent_camera_and_the_next_step) {
  try {
    AravisSource source(settings_for("127.0.20.9"), 16);
    FAIL() << "there is no such camera";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::unavailable);
    EXPECT_NE(std::string(error.what()).find("127.0.20.9"), std::string::npos);
  }
}

}  // namespace
}  // namespace rptv
