// SPDX-License-Identifier: MIT
// Replays the data sets that the project is developed on, where they are present.
#include <gtest/gtest.h>

#include <cstdlib>

#include "replay/replay_source.hpp"
#include "tests/replay/collecting_sink.hpp"

namespace rptv::testing {
namespace {

class SharedData : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* root = std::getenv("RPTV_SHARED_DATA");
    if (root == nullptr || !std::filesystem::exists(root)) GTEST_SKIP() << "no shared data";
    data = root;
  }
  std::filesystem::path data;
};

TEST_F(SharedData, wall_run_has_its_60_frames_and_no_dark_or_white_image) {
  ReplaySettings settings;
  settings.path = (data / "lf-wall").string();
  settings.rate_hz = 500;
  settings.speed = 0;
  ReplaySource source(settings);
  ASSERT_EQ(source.cameras().size(), 1U);
  EXPECT_EQ(source.cameras()[0].shape, (ImageShape{2048, 1536, 2}));
  EXPECT_EQ(source.instants(), 60U);
  CollectingSink sink(source, 64);
  source.start(sink);
  ASSERT_TRUE(sink.wait_for_frames(3));
  source.stop();
  EXPECT_EQ(source.failure(), "");
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(sink.received()[i].info.exposure_end_ns, static_cast<std::int64_t>(i) * 2'000'000);
    EXPECT_EQ(sink.received()[i].picture, read_picture(data / "lf-wall" / ("frame_00" + std::to_string(i) + ".png")));
  }
}

TEST_F(SharedData, four_cameras_are_told_apart_by_prefix) {
  const auto cameras = open_cameras(data / "four-cameras" / "density_0300");
  ASSERT_EQ(cameras.size(), 4U);
  for (const ImageSequence& camera : cameras) {
    EXPECT_EQ(camera.size(), 24U);
    EXPECT_EQ(camera.shape(), (ImageShape{1920, 1200, 1}));
  }
}

TEST_F(SharedData, real_tiff_images_of_the_cavity_are_read) {
  const auto cameras = open_cameras(data / "cavity" / "images");
  ASSERT_EQ(cameras.size(), 4U);
  EXPECT_EQ(cameras[0].camera(), "cam1");
  EXPECT_EQ(cameras[0].number(0), 10000U);
  EXPECT_EQ(cameras[0].shape(), (ImageShape{1280, 1024, 1}));
  ImageSequence::Reader reader(cameras[3]);
  std::vector<std::byte> pixels(cameras[3].shape().bytes());
  reader.decode(4, pixels);
  EXPECT_NE(*std::max_element(pixels.begin(), pixels.end()), *std::min_element(pixels.begin(), pixels.end()));
}

}  // namespace
}  // namespace rptv::testing
