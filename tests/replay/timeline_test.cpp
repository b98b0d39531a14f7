// SPDX-License-Identifier: MIT
// Frame index and time of every image, from frames.csv or from the rate.
#include "replay/timeline.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/replay/image_maker.hpp"

namespace rptv::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Times : public ::testing::Test {
 protected:
  void add(const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      std::filesystem::create_directories((folder / name).parent_path());
      write_png(folder / name, make_picture(4, 4, 1, 1).view());
    }
  }
  Timeline timeline(double rate_hz = 0, std::int64_t first_index = -1) {
    return make_timeline(folder.path(), open_cameras(folder.path()), rate_hz, first_index);
  }
  std::pair<ExitCode, std::string> refusal(double rate_hz = 0) {
    return error_of([this, rate_hz] { timeline(rate_hz); });
  }
  static std::vector<std::int64_t> times_ns(const std::vector<Shot>& shots) {
    std::vector<std::int64_t> times;
    for (const Shot& shot : shots) times.push_back(shot.time_ns);
    return times;
  }
  static std::vector<std::size_t> images(const std::vector<Shot>& shots) {
    std::vector<std::size_t> found;
    for (const Shot& shot : shots) found.push_back(shot.image);
    return found;
  }
  TemporaryFolder folder;
};

TEST_F(Times, come_from_the_rate_without_a_table) {
  add({"frame_5.png", "frame_6.png", "frame_8.png"});
  const Timeline line = timeline(500);
  EXPECT_EQ(line.clock, ClockId::nominal);
  EXPECT_EQ(line.period_ns, 2'000'000);
  EXPECT_THAT(line.index, ElementsAre(5, 6, 8));
  EXPECT_THAT(times_ns(line.shots[0]), ElementsAre(10'000'000, 12'000'000, 16'000'000));
  EXPECT_EQ(line.loop_indices, 4U);
  EXPECT_EQ(line.loop_ns, 8'000'000);
}

TEST_F(Times, of_a_rate_that_is_no_divisor_do_not_drift) {
  add({"frame_0.png", "frame_1.png"});
  const Timeline line = timeline(30, 3'000'000);
  EXPECT_EQ(line.shots[0][0].time_ns, 100'000'000'000'000);
  EXPECT_EQ(line.shots[0][1].time_ns, 100'000'033'333'333);
}

TEST_F(Times, can_start_at_a_stated_index) {
  add({"frame_5.png", "frame_6.png"});
  const Timeline line = timeline(100, 65400);
  EXPECT_THAT(line.index, ElementsAre(65400, 65401));
  EXPECT_EQ(line.shots[0][0].time_ns, 654'000'000'000);
}

TEST_F(Times, come_from_the_table_beside_the_images) {
  add({"frame_0.png", "frame_1.png", "frame_2.png"});
  write_text(folder / "frames.csv", "frame,t,exposure\n0,10.5,1\n1,10.502,1\n2,10.506,1\n");
  const Timeline line = timeline(100);
  EXPECT_EQ(line.clock, ClockId::recording);
  EXPECT_EQ(line.period_ns, 3'000'000);
  EXPECT_THAT(times_ns(line.shots[0]), ElementsAre(10'500'000'000, 10'502'000'000, 10'506'000'000));
  EXPECT_EQ(line.loop_ns, 9'000'000);
}

TEST_F(Times, belong_to_images_in_order_when_the_numbers_differ) {
  add({"frame_1.png", "frame_2.png"});
  write_text(folder / "frames.csv", "t,frame\n0.5,65400\n0.6,65402\n");
  const Timeline line = timeline();
  EXPECT_THAT(line.index, ElementsAre(65400, 65402));
  EXPECT_THAT(times_ns(line.shots[0]), ElementsAre(500'000'000, 600'000'000));
}

TEST_F(Times, of_frames_without_image_leave_a_gap) {
  add({"frame_0.png", "frame_2.png"});
  write_text(folder / "frames.csv", "frame,t\n0,0\n1,0.1\n2,0.2\n");
  EXPECT_THAT(timeline().index, ElementsAre(0, 2));
}

TEST_F(Times, belong_to_files_that_are_named) {
  add({"cam0/x_1.png", "cam0/x_2.png", "cam1/y_9.png"});
  write_text(folder / "frames.csv",
             "file,frame,t\ncam1/y_9.png,101,1.001\ncam0/x_2.png,101,1\ncam0/x_1.png,100,0.5\ncam0/x_3.png,102,1.5\n");
  const Timeline line = timeline();
  EXPECT_THAT(line.index, ElementsAre(100, 101));
  EXPECT_THAT(times_ns(line.shots[0]), ElementsAre(500'000'000, 1'000'000'000));
  EXPECT_THAT(images(line.shots[1]), ElementsAre(Shot::kNone, 0));
  EXPECT_EQ(line.shots[1][1].time_ns, 1'001'000'000);
}

TEST_F(Times, may_lie_in_each_cameras_folder) {
  add({"cam0/a_0.png", "cam0/a_1.png", "cam1/a_0.png", "cam1/a_1.png"});
  write_text(folder / "cam0/frames.csv", "frame,t\n0,0\n1,0.01\n");
  write_text(folder / "cam1/frames.csv", "frame,t\n0,0.001\n1,0.011\n");
  const Timeline line = timeline();
  EXPECT_THAT(line.index, ElementsAre(0, 1));
  EXPECT_THAT(times_ns(line.shots[1]), ElementsAre(1'000'000, 11'000'000));
  std::filesystem::remove(folder / "cam1/frames.csv");
  const auto [code, text] = refusal();
  EXPECT_EQ(code, ExitCode::no_input);
  EXPECT_THAT(text, HasSubstr("cam1/frames.csv"));
}

TEST_F(Times, pair_cameras_by_frame_number_when_one_lacks_an_image) {
  add({"cam0_0.png", "cam0_1.png", "cam0_2.png", "cam1_0.png", "cam1_2.png"});
  const Timeline line = timeline(100);
  EXPECT_THAT(images(line.shots[0]), ElementsAre(0, 1, 2));
  EXPECT_THAT(images(line.shots[1]), ElementsAre(0, Shot::kNone, 1));
}

TEST_F(Times, need_a_rate_or_a_table) {
  add({"frame_0.png"});
  const auto [code, text] = refusal();
  EXPECT_EQ(code, ExitCode::configuration);
  EXPECT_THAT(text, AllOf(HasSubstr(folder.path().string()), HasSubstr("no frames.csv"), HasSubstr("replay.rate_hz")));
}

TEST_F(Times, are_not_made_up_from_numbers_that_count_no_frames) {
  add({"frame_20240401120000.png", "frame_20240401120003.png"});
  const auto [code, text] = refusal(100);
  EXPECT_EQ(code, ExitCode::ok) << "three apart: frames 1 and 2 are missing; " << text;
  add({"frame_20240402120000.png"});
  EXPECT_THAT(refusal(100).second, HasSubstr("do not count frames"));
}

TEST_F(Times, that_do_not_fit_the_images_are_refused) {
  add({"frame_1.png", "frame_2.png", "frame_3.png"});
  const auto table = [this](const std::string& text) {
    write_text(folder / "frames.csv", text);
    const auto [code, message] = refusal();
    EXPECT_EQ(code, ExitCode::bad_data) << message;
    EXPECT_THAT(message, HasSubstr((folder / "frames.csv").string()));
    return message;
  };
  EXPECT_THAT(table("frame,t\n0,0\n1,1\n"), HasSubstr("2 rows for 3 frames"));
  EXPECT_THAT(table("frame,t\n1,0\n2,0\n3,1\n"), HasSubstr("frames.csv:3: frame and t must rise"));
  EXPECT_THAT(table("frame,t\n1,0\n2,nan\n3,1\n"), HasSubstr("frames.csv:3"));
  EXPECT_THAT(table("frame,t\n1,1e30\n2,2e30\n3,3e30\n"), HasSubstr("not a time in seconds"));
  EXPECT_THAT(table("frame,t,file\n1,0,frame_1.png\n"), HasSubstr("no row with file 'frame_2.png'"));
  EXPECT_THAT(table("frame,t,file\n1,0,frame_1.png\n2,0,frame_1.png\n"), HasSubstr("names 'frame_1.png' twice"));
  EXPECT_THAT(table("frame,t,file\n1,0,frame_1.png\n1,1,frame_2.png\n2,2,frame_3.png\n"),
              HasSubstr("do not both rise"));
  EXPECT_THAT(table("t\n1\n"), HasSubstr("frame"));
  EXPECT_THAT(table(""), HasSubstr("empty"));
}

}  // namespace
}  // namespace rptv::testing
