// SPDX-License-Identifier: MIT
// Four cameras from image files to tables, by the real binary: `run` and `reconstruct` give the same points.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/points_table.hpp"
#include "daemon/live_listener.hpp"
#include "daemon/session.hpp"
#include "tests/daemon/run_binary.hpp"
#include "tests/proto/place.hpp"
#include "tests/reconstruct/multi_view/camera_frames.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Two frames of four cameras in a folder, the rig, and the configuration that replays them.
class PaintedRecording {
 public:
  PaintedRecording() {
    testing::ViewScene scene = testing::make_scene(4, 40, 0);
    std::filesystem::create_directory(place_.file("frames"));
    for (int frame = 0; frame < 2; ++frame) {
      testing::paint(scene, frames_);
      for (std::size_t c = 0; c < 4; ++c)
        write_png(place_.file("frames/cam" + std::to_string(c) + "_" + std::to_string(frame) + ".png"),
                  frames_.set().frames[c].view());
    }
    for (std::size_t c = 0; c < 4; ++c) scene.rig.cameras[c].name = "cam" + std::to_string(c);
    write_rig(scene.rig, place_.file("cameras.toml"));
    place_.write("run.toml",
                 "[replay]\npath = \"frames\"\nrate_hz = 100.0\nspeed = 0.0\n"
                 "[intake]\npolicy = \"lossless\"\n[reconstruction]\nkind = \"multi_view\"\n"
                 "[multi_view]\nrig = \"cameras.toml\"\nmax_particles = 1000\n"
                 "[publisher]\nendpoint = \"" +
                     place_.ipc() + "\"\n");
  }
  std::string file(const std::string& name) const { return place_.file(name); }
  testing::Said check(const std::string& method = "detections") const {
    return testing::run_rapidptv({"check", "--config", file("run.toml"), "--set", "multi_view.method=" + method});
  }
  /// Every pixel of a camera's first image.
  void blank(const std::string& camera, int grey) {
    frames_.fill(0, grey);
    write_png(place_.file("frames/" + camera + "_0.png"), frames_.set().frames[0].view());
  }
  void move_all_in_rig() {
    Rig rig = read_rig(file("cameras.toml"));
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
      CameraPose pose = rig.cameras[c].model.pose();
      pose.translation_mm[1] += c % 2 == 0 ? 5 : -5;
      rig.cameras[c].model = CameraModel(rig.cameras[c].model.intrinsics(), pose);
    }
    write_rig(rig, place_.file("cameras.toml"));
  }
  void calibrate_for(int width_px, int height_px) {
    Rig rig = read_rig(file("cameras.toml"));
    CameraIntrinsics lens = rig.cameras[0].model.intrinsics();
    lens.width_px = width_px, lens.height_px = height_px;
    rig.cameras[0].model = CameraModel(lens, rig.cameras[0].model.pose());
    write_rig(rig, place_.file("cameras.toml"));
  }
  void swap_in_rig(std::size_t one, std::size_t other) {
    Rig rig = read_rig(file("cameras.toml"));
    std::swap(rig.cameras[one].name, rig.cameras[other].name);
    write_rig(rig, place_.file("cameras.toml"));
  }
  testing::Said run() const { return testing::run_rapidptv({"run", "--config", file("run.toml")}); }
  testing::Said reconstruct() const {
    return testing::run_rapidptv({"reconstruct", "--config", file("run.toml"), "-o", file("table.csv")});
  }

 private:
  Place place_;
  testing::CameraFrames frames_{{1920, 1200, 1}, 4};
};

std::vector<double> depths(const std::string& file) {
  PointsReader reader(file);
  std::vector<double> depths;
  for (PointFrame frame; reader.next(frame);)
    for (const PointRow& point : frame.points) depths.push_back(point.z_mm);
  return depths;
}

TEST(MultiViewRun, gives_the_points_that_reconstruct_gives) {
  const PaintedRecording recording;
  const auto check = recording.check();
  EXPECT_EQ(check.code, 0) << check.out << check.err;
  EXPECT_THAT(check.out, Not(HasSubstr("warning")));
  const auto run =
      testing::run_rapidptv({"run", "--config", recording.file("run.toml"), "--points", recording.file("run.csv")});
  EXPECT_EQ(run.code, 0) << run.err;
  const auto table =
      testing::run_rapidptv({"reconstruct", "--config", recording.file("run.toml"), "-o", recording.file("table.csv")});
  EXPECT_EQ(table.code, 0) << table.err;
  EXPECT_THAT(table.err, HasSubstr("reconstructed 2 of 2 instants"));
  EXPECT_GT(depths(recording.file("run.csv")).size(), 70U);
  EXPECT_EQ(depths(recording.file("run.csv")), depths(recording.file("table.csv")));

  std::filesystem::remove(recording.file("frames/cam2_1.png"));
  const auto less =
      testing::run_rapidptv({"reconstruct", "--config", recording.file("run.toml"), "-o", recording.file("less.csv")});
  EXPECT_EQ(less.code, 0) << less.err;
  EXPECT_THAT(less.err, HasSubstr("1 images were missing"));
  EXPECT_GT(depths(recording.file("less.csv")).size(), 60U);
}

TEST(MultiViewRun, by_iteration_gives_them_too_with_and_without_tracks) {
  const PaintedRecording recording;
  const std::vector<std::string> iterative{"--config", recording.file("run.toml"), "--set",
                                           "multi_view.method=iterative"};
  const auto with = [&](const std::string& command, std::vector<std::string> more) {
    more.insert(more.begin(), iterative.begin(), iterative.end());
    more.insert(more.begin(), command);
    const auto said = testing::run_rapidptv(more);
    EXPECT_EQ(said.code, 0) << said.err;
    return said.err;
  };
  with("run", {"--points", recording.file("tracked.csv")});
  with("run", {"--points", recording.file("run.csv"), "--set", "multi_view.iterative.use_tracks=false"});
  EXPECT_THAT(with("reconstruct", {"-o", recording.file("table.csv")}), HasSubstr("reconstructed 2 of 2 instants"));
  EXPECT_NEAR(static_cast<double>(depths(recording.file("table.csv")).size()), 80, 4);
  EXPECT_EQ(depths(recording.file("run.csv")), depths(recording.file("table.csv")));
  EXPECT_NEAR(static_cast<double>(depths(recording.file("tracked.csv")).size()), 80, 4);
}

TEST(MultiViewRun, is_warned_by_check_of_cameras_that_are_swapped) {
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

TEST(MultiViewRun, is_warned_of_cameras_that_moved_and_are_not_swapped) {
  PaintedRecording recording;
  recording.move_all_in_rig();
  EXPECT_THAT(recording.check().out, HasSubstr("warning  reconstruction  3 cameras see 4"));
  EXPECT_THAT(recording.run().err, HasSubstr("are cameras swapped, or have they moved since the calibration?"));
}

TEST(MultiViewRun, is_warned_of_a_camera_of_the_rig_that_has_no_images) {
  PaintedRecording recording;
  for (const char* name : {"frames/cam3_0.png", "frames/cam3_1.png"}) std::filesystem::remove(recording.file(name));
  const std::string line = "camera 'cam3' of " + recording.file("cameras.toml") + " has no images in " +
                           recording.file("frames") + ": the run goes on with 3;";
  EXPECT_THAT(recording.check().out, HasSubstr("warning  reconstruction  " + line));
  EXPECT_THAT(recording.run().err, HasSubstr(line));
  EXPECT_THAT(recording.reconstruct().err, HasSubstr("warning: " + line));
}

TEST(MultiViewRun, says_what_becomes_of_an_instant_without_one_view) {
  PaintedRecording recording;
  std::filesystem::remove(recording.file("frames/cam2_1.png"));
  const auto said = recording.run();
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.err, HasSubstr("lost: 1 × set_incomplete at cam0: another camera had no image of that instant; "
                                  "`rapidptv reconstruct` uses the views that are left"));
}

TEST(MultiViewRun, refuses_a_calibration_for_another_resolution) {
  PaintedRecording recording;
  recording.calibrate_for(1280, 1024);
  for (const auto& said : {recording.run(), recording.reconstruct()}) {
    EXPECT_EQ(said.code, 78);
    EXPECT_THAT(said.err, HasSubstr(recording.file("cameras.toml") +
                                    ": camera 'cam0' is calibrated for 1280x1024 px and its images have 1920x1200; "
                                    "use the region of interest that it was calibrated with, or calibrate it"));
  }
}

TEST(MultiViewRun, is_warned_by_check_of_a_camera_whose_images_are_saturated_or_empty) {
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

const LossCount* loss_of(const std::vector<LossCount>& losses, LossCause cause) {
  const auto found = std::find_if(losses.begin(), losses.end(), [cause](const LossCount& loss) {
    return loss.cause == cause && loss.place == "reconstruction";
  });
  return found == losses.end() ? nullptr : &*found;
}

TEST(MultiViewRun, says_in_status_and_report_what_reconstruction_left_out) {
  const PaintedRecording recording;
  Config config = load_config(recording.file("run.toml"), {"multi_view.detector.max_detections=16", "replay.loop=0"});
  config.publisher.status_period_ms = 50;
  LiveListener listener(config.publisher.endpoint);
  Session session(config);
  session.start();
  const std::int64_t deadline_ns = host_now_ns() + 60'000'000'000;
  while (loss_of(listener.status().losses, LossCause::detection_overflow) == nullptr && host_now_ns() < deadline_ns)
    listener.poll(100);
  session.stop();
  const LossCount* told = loss_of(listener.status().losses, LossCause::detection_overflow);
  ASSERT_NE(told, nullptr);
  const SessionReport report = session.report();
  const LossCount* kept = loss_of(report.losses, LossCause::detection_overflow);
  ASSERT_NE(kept, nullptr);
  EXPECT_GE(kept->count, told->count);
  EXPECT_GE(kept->count, report.counts.linked * 4 * 20) << "each view has some 40 particle images and room for 16";
  EXPECT_THAT(to_text(report), HasSubstr("lost: " + std::to_string(kept->count) +
                                         " × detection_overflow at reconstruction: raise multi_view.detector."));
  EXPECT_THAT(to_json(report), HasSubstr(R"({"place":"reconstruction","cause":"detection_overflow","count":)" +
                                         std::to_string(kept->count) + "}"));
}

TEST(MultiViewRun, of_one_light_field_says_which_key_to_set) {
  const PaintedRecording recording;
  const auto said = testing::run_rapidptv(
      {"run", "--config", recording.file("run.toml"), "--set", "reconstruction.kind=light_field"});
  EXPECT_EQ(said.code, 78);
  EXPECT_THAT(said.err,
              HasSubstr("the source has 4; give one camera's folder as its path, or set reconstruction.kind"));
}

}  // namespace
}  // namespace rptv
