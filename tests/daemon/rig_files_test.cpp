// SPDX-License-Identifier: MIT
// The real binary takes rigs from OpenPTV's and OpenCV's files, gives them back, and says what is wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "calibration/cameras/rig.hpp"
#include "core/error.hpp"
#include "tests/daemon/run_binary.hpp"
#include "tests/proto/place.hpp"

namespace rptv::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kYaml =
    "%YAML:1.0\n---\nimage_width: 1280\nimage_height: 1024\nK: [ 5800., 0., 650., 0., 5790., 500., 0., 0., 1. ]\n"
    "D: [ -0.1, 0., 1e-3, -2e-3 ]\nR: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ]\nT: [ 0., 0., 0.6 ]\n";

TEST(RigFiles, a_rig_goes_from_opencv_to_openptv_and_back) {
  const Place place;
  const std::string rig = place.file("rig.toml").string(), back = place.file("back.toml").string();
  const std::string left = place.write("left.yml", kYaml).string(), right = place.write("right.yml", kYaml).string();
  const Said import = run_rapidptv({"calibrate", "import", "opencv", left, right, "--unit-mm", "1000", "-o", rig});
  ASSERT_EQ(import.code, 0) << import.err;
  EXPECT_THAT(import.out, AllOf(HasSubstr("left "), HasSubstr("right "), HasSubstr("1280x1024 px")));
  const std::string folder = place.file("openptv").string();
  const Said exported = run_rapidptv({"calibrate", "export", "openptv", rig, "-o", folder, "--json"});
  ASSERT_EQ(exported.code, 0) << exported.err;
  EXPECT_THAT(exported.out, HasSubstr(R"({"cameras":[{"name":"left","worst_px":)"));
  const Said again = run_rapidptv({"calibrate", "import", "openptv", folder, "-o", back});
  ASSERT_EQ(again.code, 0) << again.err;
  const Rig first = read_rig(rig), second = read_rig(back);
  ASSERT_EQ(second.cameras.size(), 2U);
  const auto before = *first.cameras[1].model.project({20, 10, 5}),
             after = *second.cameras[1].model.project({20, 10, 5});
  EXPECT_NEAR(before[0], after[0], 0.01);
  EXPECT_NEAR(before[1], after[1], 0.01);
}

TEST(RigFiles, points_of_known_place_mend_a_camera) {
  const Place place;
  const std::string yaml = place.write("left.yml", kYaml).string(), rig = place.file("rig.toml").string();
  ASSERT_EQ(run_rapidptv({"calibrate", "import", "opencv", yaml, "--unit-mm", "1000", "-o", rig}).code, 0);
  const Rig start = read_rig(rig);
  CameraPose pose = start.cameras[0].model.pose();
  pose.translation_mm[0] += 3;
  const CameraModel moved(start.cameras[0].model.intrinsics(), pose);
  std::string table = "camera,x,y,z,column,row\n";
  for (int i = 0; i < 24; ++i) {
    const Point3 at{-30.0 + 20 * (i % 4), -20.0 + 20 * (i / 4 % 3), i < 12 ? 0.0 : 15.0};
    const Pixel seen = *moved.project(at);
    table += "left," + std::to_string(at[0]) + "," + std::to_string(at[1]) + "," + std::to_string(at[2]) + "," +
             std::to_string(seen[0]) + "," + std::to_string(seen[1]) + "\n";
  }
  const std::string dots = place.write("dots.csv", table).string(), fitted = place.file("fitted.toml").string();
  const Said said = run_rapidptv({"calibrate", "points", dots, "--start", rig, "--fit", "pose", "-o", fitted});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("left         24 points, 0 left out"));
  EXPECT_NEAR(read_rig(fitted).cameras[0].model.pose().translation_mm[0], pose.translation_mm[0], 1e-3);
}

TEST(RigFiles, says_which_file_is_missing_or_wrong) {
  const Place place;
  const auto refused = [&](std::vector<std::string> words, ExitCode code, const std::string& part) {
    words.insert(words.begin(), "calibrate");
    words.insert(words.end(), {"-o", place.file("none.toml").string()});
    const Said said = run_rapidptv(words);
    EXPECT_EQ(said.code, static_cast<int>(code)) << said.err;
    EXPECT_THAT(said.err, HasSubstr(part));
    EXPECT_EQ(said.out, "");
    EXPECT_FALSE(std::filesystem::exists(place.file("none.toml")));
  };
  refused({"import", "openptv", place.file("gone").string()}, ExitCode::no_input, "give OpenPTV's ptv.par");
  refused({"import", "openptv", place.write("ptv.par", "four\n").string()}, ExitCode::bad_data, "ptv.par:1: ");
  refused({"import", "opencv", place.write("a.yml", "nothing").string()}, ExitCode::bad_data, "a.yml: ");
  refused({"export", "openptv", place.write("rig.toml", "[camera_1]\n").string()}, ExitCode::configuration, "rig.toml");
}

}  // namespace
}  // namespace rptv::testing
