// SPDX-License-Identifier: MIT
// Cameras over real GigE Vision on loopback: every byte checked, every loss accounted, and back after a restart.
#include "acquisition/aravis_source.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <vector>

#include "acquisition/intake.hpp"
#include "acquisition/pixel_format.hpp"
#include "core/error.hpp"
#include "tests/acquisition/gvsp_device.hpp"

namespace rptv {
namespace {

constexpr std::int64_t kPatience_ns = 60'000'000'000;

AravisSettings settings_for(const std::string& address) {
  AravisSettings settings;
  settings.cameras = {address};
  settings.region = {0, 0, 128, 96};
  settings.rate_hz = 100;
  settings.packet_size = 1400;
  return settings;
}

/// What came: numbers of the images, and how many were not what the camera had sent.
struct Received {
  std::uint64_t images = 0, wrong = 0, first = 0, newest = 0, first_index = 0, newest_index = 0;
};

class Rig {
 public:
  explicit Rig(const AravisSettings& settings)
      : format_(settings.pixel_format), source_(settings, 16), intake_(source_.cameras(), {Bounded{8}, 16, 4}) {
    source_.start(intake_);
  }
  ~Rig() {
    intake_.close();
    source_.stop();
  }

  /// Takes images until `enough`; false when that did not come in time.
  bool take_until(const std::function<bool()>& enough) {
    const std::int64_t deadline_ns = host_now_ns() + kPatience_ns;
    FrameSet set;
    while (!enough() && host_now_ns() < deadline_ns)
      if (intake_.next(set, 50'000'000) == Taken::value) look(set.frames[0]);
    return enough();
  }
  const Received& received() const { return received_; }
  std::uint64_t lost() const { return intake_.losses(0).total(); }
  DeviceStatus status() const { return source_.device_status()[0]; }

 private:
  void look(const Frame& frame) {
    const std::vector<std::uint8_t> sent = as_sent(frame);
    const std::uint64_t number = sequence_of(sent.data(), sent.size());
    received_.wrong += number <= received_.newest || frame.info.index <= received_.newest_index;
    if (received_.images++ == 0) {
      received_.first = number;
      received_.first_index = frame.info.index;
    }
    received_.newest = number;
    received_.newest_index = frame.info.index;
  }
  /// The payload that makes this image.
  std::vector<std::uint8_t> as_sent(const Frame& frame) const {
    const std::uint8_t* bytes = frame.view().as_u8();
    if (find_pixel_format(format_)->unpack == nullptr) return {bytes, bytes + frame.shape.bytes()};
    const std::uint16_t* pixels = frame.view().as_u16();
    const std::size_t count = frame.shape.bytes() / 2;
    std::vector<std::uint8_t> sent;
    if (format_ == "Mono12Packed") {
      for (std::size_t i = 0; i < count; i += 2)
        for (const int byte : {pixels[i] >> 4, (pixels[i] & 15) | (pixels[i + 1] & 15) << 4, pixels[i + 1] >> 4})
          sent.push_back(static_cast<std::uint8_t>(byte));
      return sent;
    }
    std::uint32_t bits = 0, held = 0;  // a stream, lowest bit first
    for (std::size_t i = 0; i < count; ++i) {
      bits |= std::uint32_t{pixels[i]} << held;
      for (held += find_pixel_format(format_)->payload_bits; held >= 8; held -= 8, bits >>= 8)
        sent.push_back(static_cast<std::uint8_t>(bits));
    }
    return sent;
  }

  const std::string format_;
  AravisSource source_;
  Intake intake_;
  Received received_;
};

class AravisSourceFormats : public testing::TestWithParam<const char*> {};

TEST_P(AravisSourceFormats, gives_every_byte_that_the_camera_sent) {
  GvspDevice device("127.0.20.1", {});
  AravisSettings settings = settings_for("127.0.20.1");
  settings.pixel_format = GetParam();
  Rig rig(settings);
  ASSERT_TRUE(rig.take_until([&] { return rig.received().images >= 50; })) << rig.status().problem;
  EXPECT_EQ(rig.received().wrong, 0U);
  EXPECT_EQ(rig.status().sessions, 1U);
  EXPECT_EQ(rig.received().images + rig.lost(), rig.received().newest - rig.received().first + 1);
}

INSTANTIATE_TEST_SUITE_P(Mono, AravisSourceFormats,
                         testing::Values("Mono8", "Mono16", "Mono10p", "Mono12p", "Mono12Packed"));

TEST(AravisSource, loses_no_image_uncounted_when_packets_are_lost_doubled_and_swapped) {
  for (const bool answers : {true, false}) {
    GvspDevice device("127.0.20.2", {0.02, 0.02, 0.02, answers, 65400, 7});
    AravisSettings settings = settings_for("127.0.20.2");
    settings.packet_resend = answers;
    Rig rig(settings);
    ASSERT_TRUE(rig.take_until([&] { return rig.received().newest >= 250; })) << rig.status().problem;
    EXPECT_EQ(rig.received().wrong, 0U);
    EXPECT_EQ(rig.received().newest_index - rig.received().first_index, rig.received().newest - rig.received().first)
        << "indices go through the wrap";
    // Losses before the first image and after the last one taken are counted as well, so: at least.
    EXPECT_GE(rig.received().images + rig.lost(), rig.received().newest - rig.received().first + 1);
    EXPECT_GT(answers ? device.resent() : rig.lost(), 0U) << "the faults reached us";
  }
}

TEST(AravisSource, goes_on_when_the_camera_was_restarted) {
  auto device = std::make_unique<GvspDevice>("127.0.20.3", GvspFaults{});
  Rig rig(settings_for("127.0.20.3"));
  for (std::uint64_t session = 1; session <= 5; ++session) {
    const std::uint64_t before = rig.received().images;
    ASSERT_TRUE(rig.take_until([&] {
      return rig.status().sessions >= session && rig.received().images >= before + 10;
    })) << rig.status().problem;
    device->stop();
    const std::uint64_t sent = device->sent();
    device.reset();
    device = std::make_unique<GvspDevice>("127.0.20.3", GvspFaults{}, sent);
  }
  EXPECT_EQ(rig.received().wrong, 0U) << "no image comes twice, and indices grow";
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
