// SPDX-License-Identifier: MIT
// What a replay delivers: exact pixels, indices and times over loops, several cameras, clean ends, and failures.
#include "replay/replay_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/replay/collecting_sink.hpp"
#include "tests/replay/image_maker.hpp"

namespace rptv::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Replay : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kFrames = 6;

  Replay() {
    settings.path = folder.path().string();
    settings.rate_hz = 1000;
    settings.speed = 0;
  }
  Picture picture(std::uint32_t camera, std::uint32_t frame) const {
    return make_picture(24, 16, 2, camera * 1000 + frame);
  }
  /// Images of one camera, or of several by prefix.
  void make(std::uint32_t cameras = 1, std::uint32_t frames = kFrames) {
    for (std::uint32_t camera = 0; camera < cameras; ++camera)
      for (std::uint32_t frame = 0; frame < frames; ++frame)
        write_png(folder / ((cameras > 1 ? "cam" + std::to_string(camera) : std::string("frame")) + "_" +
                            std::to_string(frame) + ".png"),
                  picture(camera, frame).view());
  }
  static std::vector<std::uint64_t> indices(const std::vector<Received>& frames) {
    std::vector<std::uint64_t> found;
    for (const Received& frame : frames) found.push_back(frame.info.index);
    return found;
  }

  TemporaryFolder folder;
  ReplaySettings settings;
};

TEST_F(Replay, delivers_every_pixel_decoded_or_preloaded) {
  make();
  for (const bool preload : {false, true}) {
    settings.preload = preload;
    ReplaySource source(settings);
    CollectingSink sink(source, 16);
    source.start(sink);
    ASSERT_TRUE(sink.wait_for_end());
    source.stop();
    ASSERT_EQ(sink.received().size(), kFrames);
    for (std::uint32_t i = 0; i < kFrames; ++i) {
      EXPECT_EQ(sink.received()[i].picture, picture(0, i)) << i;
      EXPECT_FALSE(sink.received()[i].info.torn);
    }
    EXPECT_EQ(sink.ends(), 1);
    EXPECT_EQ(source.failure(), "");
  }
}

TEST_F(Replay, describes_its_cameras) {
  make(3);
  settings.significant_bits = 12;
  const ReplaySource source(settings);
  ASSERT_EQ(source.cameras().size(), 3U);
  EXPECT_EQ(source.cameras()[2].name, "cam2");
  EXPECT_EQ(source.cameras()[2].shape, (ImageShape{24, 16, 2}));
  EXPECT_EQ(source.cameras()[2].significant_bits, 12U);
  EXPECT_EQ(source.nominal_period_ns(), 1'000'000);
}

TEST_F(Replay, goes_on_in_index_and_time_over_loops) {
  make();
  write_text(folder / "frames.csv", "frame,t\n10,1\n11,1.001\n12,1.002\n13,1.003\n14,1.004\n15,1.005\n");
  settings.loop = 3;
  ReplaySource source(settings);
  EXPECT_EQ(source.instants(), 18U);
  CollectingSink sink(source, 32);
  source.start(sink);
  ASSERT_TRUE(sink.wait_for_end());
  source.stop();
  ASSERT_EQ(sink.received().size(), 18U);
  for (std::size_t i = 0; i < 18; ++i) {
    const FrameInfo& info = sink.received()[i].info;
    EXPECT_EQ(info.index, 10 + i);
    EXPECT_EQ(info.clock, ClockId::recording);
    EXPECT_EQ(info.exposure_end_ns, 1'000'000'000 + static_cast<std::int64_t>(i) * 1'000'000);
    EXPECT_EQ(sink.received()[i].picture, picture(0, static_cast<std::uint32_t>(i % kFrames)));
  }
}

TEST_F(Replay, of_one_image_can_be_repeated_at_a_rate) {
  make(1, 1);
  settings.loop = 4;
  ReplaySource source(settings);
  CollectingSink sink(source, 16);
  source.start(sink);
  ASSERT_TRUE(sink.wait_for_end());
  source.stop();
  EXPECT_THAT(indices(sink.received()), ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(sink.received()[3].info.exposure_end_ns, 3'000'000);
}

TEST_F(Replay, keeps_deadlines_of_the_recording_at_any_speed) {
  make();
  for (const double speed : {1.0, 4.0}) {
    settings.speed = speed;
    settings.preload = true;
    ReplaySource source(settings);
    CollectingSink sink(source, 16);
    source.start(sink);
    ASSERT_TRUE(sink.wait_for_end());
    source.stop();
    const FrameInfo first = sink.received()[0].info;
    for (const Received& frame : sink.received()) {
      const std::int64_t recorded_ns = frame.info.exposure_end_ns - first.exposure_end_ns;
      EXPECT_EQ(recorded_ns, static_cast<std::int64_t>(frame.info.index) * 1'000'000);
      EXPECT_NEAR(static_cast<double>(frame.info.exposure_end_host_ns - first.exposure_end_host_ns),
                  static_cast<double>(recorded_ns) / speed, 1.0);
      EXPECT_GE(frame.info.arrival_ns, frame.info.exposure_end_host_ns) << "delivered before it was due";
    }
  }
}

TEST_F(Replay, stamps_frames_with_the_host_clock_when_it_does_not_wait) {
  make();
  ReplaySource source(settings);
  CollectingSink sink(source, 16);
  const std::int64_t before_ns = host_now_ns();
  source.start(sink);
  ASSERT_TRUE(sink.wait_for_end());
  source.stop();
  for (const Received& frame : sink.received()) {
    EXPECT_GE(frame.info.exposure_end_host_ns, before_ns);
    EXPECT_GE(frame.info.arrival_ns, frame.info.exposure_end_host_ns);
    EXPECT_LE(frame.info.arrival_ns, host_now_ns());
  }
}

TEST_F(Replay, keeps_cameras_within_two_instants_of_each_other) {
  make(4, 50);
  settings.preload = true;
  settings.loop = 4;
  ReplaySource source(settings);
  CollectingSink sink(source, 256);
  source.start(sink);
  ASSERT_TRUE(sink.wait_for_end());
  source.stop();
  ASSERT_EQ(sink.received().size(), 4U * 50 * 4);
  std::array<std::uint64_t, 4> done{};
  for (const Received& frame : sink.received()) {
    EXPECT_EQ(frame.info.index, done[frame.info.camera]++);
    EXPECT_EQ(frame.picture, picture(frame.info.camera, static_cast<std::uint32_t>(frame.info.index % 50)));
    // a camera that has delivered but not yet said so counts as one behind
    EXPECT_LE(*std::max_element(done.begin(), done.end()) - *std::min_element(done.begin(), done.end()), 3U);
  }
}

TEST_F(Replay, gives_every_camera_what_it_has) {
  make(2);
  std::filesystem::remove(folder / "cam1_2.png");
  ReplaySource source(settings);
  CollectingSink sink(source, 16);
  source.start(sink);
  ASSERT_TRUE(sink.wait_for_end());
  source.stop();
  EXPECT_THAT(indices(sink.received(0)), ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THAT(indices(sink.received(1)), ElementsAre(0, 1, 3, 4, 5));
  EXPECT_EQ(sink.received(1)[2].picture, picture(1, 3));
}

TEST_F(Replay, stops_at_once_in_the_middle_of_a_long_wait) {
  make();
  settings.rate_hz = 1e-3;  // the second frame is due in a quarter of an hour
  settings.speed = 1;
  ReplaySource source(settings);
  CollectingSink sink(source, 16);
  source.start(sink);
  ASSERT_TRUE(sink.wait_for_frames(1));
  source.stop();  // the test's time limit is the assertion
  EXPECT_EQ(sink.received().size(), 1U);
  EXPECT_EQ(sink.ends(), 0);
  source.stop();
}

TEST_F(Replay, stops_when_it_would_play_for_ever) {
  make(2);
  settings.loop = 0;
  settings.preload = true;
  ReplaySource source(settings);
  EXPECT_EQ(source.instants(), UINT64_MAX);
  CollectingSink sink(source, 16);
  source.start(sink);
  ASSERT_TRUE(sink.wait_for_frames(100));
  source.stop();
  EXPECT_EQ(sink.ends(), 0);
}

TEST_F(Replay, delivers_a_file_that_broke_while_playing_as_torn_and_goes_on) {
  make();
  ReplaySource source(settings);
  cut_short(folder / "frame_2.png", 0.6);
  std::filesystem::remove(folder / "frame_4.png");
  CollectingSink sink(source, 16);
  source.start(sink);
  ASSERT_TRUE(sink.wait_for_end());
  source.stop();
  ASSERT_EQ(sink.received().size(), kFrames);
  for (std::uint32_t i = 0; i < kFrames; ++i) {
    EXPECT_EQ(sink.received()[i].info.torn, i == 2 || i == 4);
    if (i == 2 || i == 4) continue;
    EXPECT_EQ(sink.received()[i].picture, picture(0, i));
  }
  EXPECT_EQ(source.undecodable(0), 2U);
  EXPECT_EQ(source.injected(0).torn, 0U);
  EXPECT_THAT(source.failure(), AllOf(HasSubstr("frame_2.png"), HasSubstr("truncated")));
}

}  // namespace
}  // namespace rptv::testing
