// SPDX-License-Identifier: MIT
// Recordings by several cameras that something is wrong with, by the real binary: each is named, with the next step.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/daemon/painted_recording.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::PaintedRecording;

TEST(MultiViewDoubts, is_warned_by_check_of_cameras_that_are_swapped) {
  PaintedRecording recording;
  EXPECT_THAT(recording.check("iterative").out, Not(HasSubstr("warning")));
  recording.swap_in_rig(1, 2);
  for (const char* method : {"detections", "iterative"}) {
    const auto said = recording.check(method);
    EXPECT_EQ(said.code, 0) << said.err;
    EXPECT_THAT(said.out, HasSubstr("warning  reconstruction  cameras 'cam1' and 'cam2' are swapped: "));
    EXPECT_THAT(said.out, HasSubstr("exchange their names in " + recording.file("cameras.toml") + ", or their images"));
  }
  for (const auto& said : {recording.run(), recording.reconstruct()}) {
    EXPECT_EQ(said.code, 0) << said.err;
    EXPECT_THAT(said.err, HasSubstr("cameras 'cam1' and 'cam2' are swapped: "));
  }
}

TEST(MultiViewDoubts, is_told_of_a_later_image_that_is_saturated_or_empty) {
  PaintedRecording recording;
  for (const int grey : {0, 255}) {
    recording.blank("cam2", grey, "1");
    const auto said = recording.reconstruct();
    EXPECT_EQ(said.code, 0) << said.err;
    EXPECT_THAT(said.err, HasSubstr("warning: camera 'cam2' sees next to no particles and the others do: it is dark, "
                                    "saturated or covered; look at its images"));
    EXPECT_THAT(said.err, HasSubstr("; in 1 of 2 instants, first at frame 1\n"));
  }
}

TEST(MultiViewDoubts, is_warned_of_cameras_that_moved_and_are_not_swapped) {
  PaintedRecording recording;
  recording.move_all_in_rig();
  EXPECT_THAT(recording.check().out, HasSubstr("warning  reconstruction  3 cameras see 4"));
  EXPECT_THAT(recording.run().err, HasSubstr("are cameras swapped, or have they moved since the calibration?"));
}

TEST(MultiViewDoubts, is_warned_of_a_camera_of_the_rig_that_has_no_images) {
  PaintedRecording recording;
  for (const char* name : {"frames/cam3_0.png", "frames/cam3_1.png"}) std::filesystem::remove(recording.file(name));
  const std::string line = "camera 'cam3' of " + recording.file("cameras.toml") + " has no images in " +
                           recording.file("frames") + ": the run goes on with 3;";
  EXPECT_THAT(recording.check().out, HasSubstr("warning  reconstruction  " + line));
  EXPECT_THAT(recording.run().err, HasSubstr(line));
  EXPECT_THAT(recording.reconstruct().err, HasSubstr("warning: " + line));
}

TEST(MultiViewDoubts, says_what_becomes_of_an_instant_without_one_view) {
  PaintedRecording recording;
  std::filesystem::remove(recording.file("frames/cam2_1.png"));
  const auto said = recording.run();
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.err, HasSubstr("lost: 1 × set_incomplete at cam0: another camera had no image of that instant; "
                                  "`rapidptv reconstruct` uses the views that are left"));
}

TEST(MultiViewDoubts, refuses_a_calibration_for_another_resolution) {
  PaintedRecording recording;
  recording.calibrate_for(1280, 1024);
  for (const auto& said : {recording.run(), recording.reconstruct()}) {
    EXPECT_EQ(said.code, 78);
    EXPECT_THAT(said.err, HasSubstr(recording.file("cameras.toml") +
                                    ": camera 'cam0' is calibrated for 1280x1024 px and its images have 1920x1200; "
                                    "use the region of interest that it was calibrated with, or calibrate it"));
  }
}

TEST(MultiViewDoubts, is_warned_by_check_of_a_camera_whose_images_are_saturated_or_empty) {
  PaintedRecording recording;
  recording.blank("cam2", 255);
  recording.blank("cam3", 0);
  const auto said = recording.check();
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("camera 'cam2', " + recording.file("frames/cam2_0.png") +
                                  ": 100 % of the image is saturated; shorten"));
  EXPECT_THAT(said.out,
              HasSubstr("camera 'cam3', " + recording.file("frames/cam3_0.png") + ": every pixel is 0; look"));
  EXPECT_THAT(said.out, Not(HasSubstr("swapped")));
  for (const auto& ran : {recording.run(), recording.reconstruct()}) {
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_THAT(ran.err, HasSubstr("camera 'cam2', " + recording.file("frames/cam2_0.png") + ": 100 % of the image"));
    EXPECT_THAT(ran.err, HasSubstr("camera 'cam3', " + recording.file("frames/cam3_0.png") + ": every pixel is 0"));
  }
}

}  // namespace
}  // namespace rptv
