// SPDX-License-Identifier: MIT
// What a replay refuses before it starts, and how it preloads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "replay/replay_source.hpp"
#include "tests/replay/image_maker.hpp"

namespace rptv::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ReplaySetUp : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kFrames = 6;

  ReplaySetUp() {
    settings.path = folder.path().string();
    settings.rate_hz = 1000;
  }
  void make() {
    for (std::uint32_t frame = 0; frame < kFrames; ++frame)
      write_png(folder / ("frame_" + std::to_string(frame) + ".png"), make_picture(24, 16, 2, frame).view());
  }

  TemporaryFolder folder;
  ReplaySettings settings;
};

TEST_F(ReplaySetUp, refuses_to_preload_above_its_limit) {
  for (const std::uint32_t frame : {0U, 1U})
    write_png(folder / ("frame_" + std::to_string(frame) + ".png"), make_picture(800, 700, 1, frame).view());
  settings.preload = true;
  settings.preload_limit_mb = 1;
  const auto [code, text] = error_of([this] { ReplaySource source(settings); });
  EXPECT_EQ(code, ExitCode::configuration);
  EXPECT_THAT(text, AllOf(HasSubstr("2 decoded images take 2 MB"), HasSubstr("preload_limit_mb = 1")));
}

TEST_F(ReplaySetUp, names_the_damaged_file_when_it_preloads) {
  make();
  std::fstream stream(folder / "frame_3.png", std::ios::in | std::ios::out | std::ios::binary);
  stream.seekp(100);
  stream << "damage";
  stream.close();
  settings.preload = true;
  const auto [code, text] = error_of([this] { ReplaySource source(settings); });
  EXPECT_EQ(code, ExitCode::bad_data);
  EXPECT_THAT(text, HasSubstr((folder / "frame_3.png").string()));
}

TEST_F(ReplaySetUp, reports_the_progress_of_preloading) {
  make();
  settings.preload = true;
  std::vector<std::size_t> reported;
  const ReplaySource source(settings, [&](std::size_t done, std::size_t total) {
    EXPECT_EQ(total, kFrames);
    reported.push_back(done);
  });
  EXPECT_TRUE(std::is_sorted(reported.begin(), reported.end()));
  EXPECT_LE(reported.size(), kFrames);
}

TEST_F(ReplaySetUp, refuses_more_significant_bits_than_the_images_have) {
  write_png(folder / "frame_0.png", make_picture(8, 8, 1, 1).view());
  settings.significant_bits = 12;
  EXPECT_THAT(error_of([this] { ReplaySource source(settings); }).second,
              AllOf(HasSubstr("significant_bits = 12"), HasSubstr("8 bits per pixel")));
}

TEST_F(ReplaySetUp, refuses_to_repeat_one_image_without_a_rate) {
  write_png(folder / "frame_0.png", make_picture(8, 8, 1, 1).view());
  write_text(folder / "frames.csv", "frame,t\n0,0\n");
  settings.rate_hz = 0;
  settings.loop = 2;
  const auto [code, text] = error_of([this] { ReplaySource source(settings); });
  EXPECT_EQ(code, ExitCode::configuration);
  EXPECT_THAT(text, HasSubstr("replay.rate_hz"));
}

}  // namespace
}  // namespace rptv::testing
