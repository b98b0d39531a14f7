// SPDX-License-Identifier: MIT
// The real binary calibrates a rig from points that its cameras saw, reports it, and says in one line why it will not.
#include <gmock/gmock.h>

#include <fstream>

#include "calibration/cameras/rig.hpp"
#include "core/error.hpp"
#include "replay/image_file.hpp"
#include "tests/calibration/cameras/board_rig.hpp"
#include "tests/daemon/run_binary.hpp"
#include "tests/proto/place.hpp"

namespace rptv::testing {
namespace {

using ::testing::HasSubstr;

/// A cube of points before four cameras, as text files.
class CalibrateCamerasCommand : public ::testing::Test {
 protected:
  CalibrateCamerasCommand() : rig_(cube(), 4) {
    std::string known;
    for (std::size_t k = 0; k < rig_.set.target_mm.size(); ++k) {
      const Point3& p = rig_.set.target_mm[k];
      known += std::to_string(100 + k) + " " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " +
               std::to_string(p[2]) + "\n";
    }
    place_.write("cube.txt", known);
    place_.write("cube.toml", "schema = 1\nkind = \"points\"\npoints_file = \"cube.txt\"\n");
    place_.write("charuco.toml",
                 "schema = 1\nkind = \"charuco\"\ncolumns = 7\nrows = 10\nsquare_mm = 20\nmarker_mm = 15\n");
    for (const char* folder : {"seen", "many"}) std::filesystem::create_directory(place_.file(folder));
    write_points("seen/", rig_.set, 100);
  }

  /// A text file for each image; points are numbered from `first_id`.
  void write_points(const std::string& folder, const BoardSet& set, std::size_t first_id) const {
    for (const auto& image : set.images) {
      std::string text;
      for (const auto& s : image.seen)
        text += std::to_string(first_id + s.point) + " " + std::to_string(s.pixel[0]) + " " +
                std::to_string(s.pixel[1]) + "\n";
      place_.write(folder + image.origin + ".txt", text);
    }
  }

  static std::vector<Point3> cube() {
    std::vector<Point3> points;
    for (double x : {-40.0, 0.0, 40.0})
      for (double y : {-40.0, 5.0, 40.0})
        for (double z : {-40.0, 0.0, 40.0}) points.push_back({x, y + 0.1 * x, z});
    return points;
  }
  std::string path(const char* name) const { return place_.file(name).string(); }
  Said calibrate(std::vector<std::string> more) const {
    std::vector<std::string> words{"calibrate", "cameras", "-o", path("rig.toml")};
    words.insert(words.end(), more.begin(), more.end());
    return run_rapidptv(words);
  }
  void expect_refusal(const Said& said, ExitCode code, const std::string& text) const {
    EXPECT_EQ(said.code, static_cast<int>(code)) << said.err;
    EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
    EXPECT_THAT(said.err, HasSubstr(text));
    EXPECT_FALSE(std::filesystem::exists(path("rig.toml")));
  }
  void write_image(const char* name, std::uint32_t width, std::uint8_t value) const {
    const std::vector<std::byte> pixels(width * 48U, std::byte{value});
    write_png(place_.file(name), {pixels.data(), {width, 48, 1}});
  }

  Place place_;
  BoardRig rig_;
};

TEST_F(CalibrateCamerasCommand, gives_a_rig_and_a_report) {
  const Said said = calibrate({path("seen"), "--pattern", "cam{camera}_{view}.txt", "--board", path("cube.toml"),
                               "--size", "1280", "1024", "--report", path("report")});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("reprojection      rms 0.00"));
  EXPECT_THAT(said.out, HasSubstr("camera cam3"));
  const Rig rig = read_rig(path("rig.toml"));
  ASSERT_EQ(rig.cameras.size(), 4U);
  EXPECT_EQ(rig.cameras[2].name, "cam2");
  EXPECT_LT(angle_deg(rig.cameras[2].model.pose().rotation * transpose(rig_.from_first(2).rotation)), 0.05);
  for (const char* file : {"report/report.txt", "report/report.json", "report/residuals.csv", "report/coverage.png"})
    EXPECT_GT(std::filesystem::file_size(path(file)), 500U) << file;
}

TEST_F(CalibrateCamerasCommand, takes_names_apart_as_the_pattern_says) {
  for (std::size_t c = 0; c < 4; ++c) {
    const std::string folder = "cameras/c" + std::to_string(c);
    std::filesystem::create_directories(place_.file(folder));
    for (std::size_t v = 0; v < 4; ++v)
      std::filesystem::copy(place_.file("seen/" + rig_.image(c, v).origin + ".txt"),
                            place_.file(folder + "/pose_" + std::to_string(v) + "_a.txt"));
  }
  const Said said = calibrate({path("cameras"), "--pattern", "{camera}/pose_{view}_*.txt", "--board", path("cube.toml"),
                               "--size", "1280", "1024", "--world-view", "1", "--json"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("\"name\":\"c3\""));
  // the frame is the cube's of view 1
  const CameraPose truth = after(rig_.truth.cameras[3], *rig_.truth.targets[1]);
  const Point3 centre = inverse(read_rig(path("rig.toml")).cameras[3].model.pose()).translation_mm;
  EXPECT_LT(norm(centre - inverse(truth).translation_mm), 2);
}

TEST_F(CalibrateCamerasCommand, takes_one_window_for_all_cameras_or_one_for_each) {
  const auto with = [&](std::vector<std::string> glass) {
    std::vector<std::string> words{
        path("seen"), "--pattern", "cam{camera}_{view}.txt", "--board", path("cube.toml"), "--size", "1280", "1024"};
    words.insert(words.end(), glass.begin(), glass.end());
    return calibrate(words);
  };
  const auto window = [](const std::string& distance) {
    return std::vector<std::string>{"--glass", distance, "6", "1.0", "1.0"};  // which bends nothing
  };
  std::vector<std::string> each;
  for (const char* distance : {"700", "cam1:500", "cam3:600"})
    for (const std::string& word : window(distance)) each.push_back(word);

  expect_refusal(with(window("cam9:700")), ExitCode::usage, "no camera 'cam9'; the first is 'cam0', the last 'cam3'");
  expect_refusal(with(window("cam1:near")), ExitCode::usage, "--glass: 'near' is no positive number");
  expect_refusal(with(window("cam1:500")), ExitCode::usage, "camera 'cam0' has no window and others have");
  std::vector<std::string> twice = each;
  twice.insert(twice.end(), each.begin(), each.begin() + 5);
  expect_refusal(with(twice), ExitCode::usage, "--glass 700 is given twice");

  std::vector<std::string> fitted{"--glass", "cam0:700", "6", "1.0", "1.0", "--fit-glass"};
  for (const char* camera : {"cam1:700", "cam2:700", "cam3:700"})
    for (const std::string& word : window(camera)) fitted.push_back(word);
  expect_refusal(with(fitted), ExitCode::usage,
                 "--fit-glass turns the window that cameras share, and each has its own");

  const Said said = with(each);
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("index 1 behind, camera cam3"));
  const Rig rig = read_rig(path("rig.toml"));
  const auto distance_mm = [&](std::size_t camera) {
    const CameraModel& model = rig.cameras[camera].model;
    const Point3 centre = inverse(model.pose()).translation_mm;
    return dot(model.stack().normal, centre) - model.stack().interfaces[0].position_mm;
  };
  EXPECT_NEAR(distance_mm(0), 700, 1e-6);
  EXPECT_NEAR(distance_mm(1), 500, 1e-6);
  EXPECT_NEAR(distance_mm(3), 600, 1e-6);
  EXPECT_EQ(rig.cameras[2].model.stack().normal, rig.cameras[0].model.stack().normal);
}

TEST_F(CalibrateCamerasCommand, improves_a_rig_by_a_wand) {
  const BoardRig rod({{-50, 0, 0}, {50, 0, 0}}, 30, 0.05);
  Rig start;
  for (std::size_t c = 0; c < 4; ++c) {
    CameraPose pose = rod.truth.cameras[c];
    if (c == 2) pose.translation_mm[0] += 0.5;
    start.cameras.push_back({rod.set.cameras[c].name, CameraModel(rod.truth.lenses[c], pose)});
  }
  write_rig(start, place_.file("start.toml"));
  std::filesystem::create_directory(place_.file("ends"));
  write_points("ends/", rod.set, 1);
  const auto wand = [&](const std::string& length) {
    return run_rapidptv(
        {"calibrate", "wand", path("ends"), "--start", path("start.toml"), "--length", length, "-o", path("rig.toml")});
  };
  expect_refusal(wand("150"), ExitCode::bad_data, "the rod is 100.");
  const Said said = wand("100");
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("rods              30 views"));
  const CameraPose found = read_rig(path("rig.toml")).cameras[2].model.pose(), &truth = rod.truth.cameras[2];
  EXPECT_LT(norm(inverse(found).translation_mm - inverse(truth).translation_mm), 0.3);
}

TEST_F(CalibrateCamerasCommand, says_why_not) {
  const std::string points = path("cube.toml"), seen = path("seen");
  const auto of_points = [&](std::vector<std::string> more) {
    more.insert(more.end(), {seen, "--board", points, "--pattern", "cam{camera}_{view}.txt"});
    return calibrate(more);
  };
  expect_refusal(of_points({}), ExitCode::usage, "--size");
  expect_refusal(of_points({"--size", "1280", "1024", "--world-view", "9"}), ExitCode::usage, "'9'");
  expect_refusal(calibrate({seen, "--board", points, "--pattern", "cam{camera}.txt"}), ExitCode::usage, "{view}");
  expect_refusal(calibrate({seen, "--board", path("charuco.toml")}), ExitCode::bad_data, "cam0_0.txt");
  expect_refusal(calibrate({path("nowhere"), "--board", points}), ExitCode::no_input, "nowhere");
  for (int c = 0; c < 17; ++c) place_.write("many/cam" + std::to_string(c) + "_0.txt", "100 1 2\n");
  expect_refusal(calibrate({path("many"), "--board", points, "--pattern", "cam{camera}_{view}.txt"}),
                 ExitCode::bad_data, "of 17 cameras and a rig has at most 16");
  std::filesystem::remove(place_.file("seen/cam2_3.txt"));
  expect_refusal(of_points({"--size", "1280", "1024"}), ExitCode::bad_data, "camera cam2 has no image of view 3");
}

TEST_F(CalibrateCamerasCommand, refuses_images_that_cannot_serve) {
  std::filesystem::create_directory(place_.file("images"));
  const auto of_images = [&] { return calibrate({path("images"), "--board", path("charuco.toml")}); };
  write_image("images/cam0_0.png", 64, 3);
  write_image("images/cam1_0.png", 64, 3);
  expect_refusal(of_images(), ExitCode::bad_data, "cam0_0.png: is empty");
  write_image("images/cam0_0.png", 64, 255);
  expect_refusal(of_images(), ExitCode::bad_data, "cam0_0.png: is saturated");
  std::vector<std::byte> stripes(64 * 48, std::byte{10});
  for (std::size_t i = 0; i < stripes.size(); i += 2) stripes[i] = std::byte{200};
  for (const char* name : {"images/cam0_0.png", "images/cam1_0.png", "images/cam0_1.png"})
    write_png(place_.file(name), {stripes.data(), {64, 48, 1}});
  write_image("images/cam1_1.png", 32, 3);
  expect_refusal(of_images(), ExitCode::bad_data, "cam1_1.png: is 32x48 px and the images of camera cam1");
  write_png(place_.file("images/cam1_1.png"), {stripes.data(), {64, 48, 1}});
  expect_refusal(of_images(), ExitCode::bad_data, "show no part of the board");
}

}  // namespace
}  // namespace rptv::testing
