// SPDX-License-Identifier: MIT
// OpenCV's calibration files in the spellings that are about, and what they may not hold.
#include "calibration/cameras/opencv_yaml.hpp"

#include <gtest/gtest.h>

#include "calibration/space_algebra.hpp"
#include "core/error.hpp"
#include "tests/proto/place.hpp"

namespace rptv {
namespace {

const std::string kYaml =
    "%YAML:1.0\n---\nimage_width: 1280\nimage_height: 1024\n"
    "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
    "   data: [ 5800., 0., 630., 0., 5790., 500., 0., 0., 1. ]\n"
    "distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n"
    "   data: [ -0.1, 0.2, 1e-3, -2e-3, 0.3 ]\n";

CameraModel parse(const std::string& text, double unit_mm = 1) {
  return parse_opencv_camera(text, unit_mm, "left.yml");
}

std::string refusal(const std::string& text) {
  try {
    parse(text);
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "";
}

TEST(OpencvYaml, a_lens_is_read_in_opencvs_order) {
  const CameraIntrinsics lens = parse(kYaml).intrinsics();
  const CameraIntrinsics expected{1280, 1024, 5800, 5790, 630, 500, 0, -0.1, 0.2, 0.3, 1e-3, -2e-3};
  EXPECT_EQ(lens, expected);
  EXPECT_EQ(parse(kYaml).pose(), CameraPose{});
}

TEST(OpencvYaml, a_pose_may_be_a_matrix_or_a_vector_and_in_metres) {
  const std::string vector = kYaml + "rvec: [ 0., 0., 1.5707963267948966 ]\ntvec: [ 0.1, 0., 0.6 ]\n";
  const CameraPose turned = parse(vector, 1000).pose();
  EXPECT_NEAR(turned.rotation[1][0], 1, 1e-15);
  EXPECT_NEAR(turned.rotation[0][1], -1, 1e-15);
  EXPECT_EQ(turned.translation_mm, (Point3{100, 0, 600}));
  const std::string matrix =
      kYaml +
      "R: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 0., -1., 0., 1., 0., 0., "
      "0., 0., 1. ]\nT: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ 100., 0., "
      "600. ]\n";
  EXPECT_EQ(parse(matrix).pose().translation_mm, turned.translation_mm);
  EXPECT_EQ(parse(matrix).pose().rotation[1][0], 1);
}

TEST(OpencvYaml, other_spellings_are_understood) {
  EXPECT_EQ(parse("%YAML:1.0\n---\nimage_size: [ 640, 480 ]\nK: [ 900, 0, 320, 0, 900, 240, 0, 0, 1 ]\nD: [ 0.1, 0 ]\n")
                .intrinsics()
                .k1,
            0.1);
  const CameraModel json = parse(
      R"({"image_width": 640, "image_height": 480, "cameraMatrix": [900, 0, 320, 0, 900, 240, 0, 0, 1], "distCoeffs": [0.1]})");
  EXPECT_EQ(json.intrinsics().width_px, 640);
}

TEST(OpencvYaml, a_rig_is_one_file_per_camera) {
  const Place place;
  const Rig rig = import_opencv({place.write("left.yml", kYaml), place.write("right.yml", kYaml)}, 1);
  ASSERT_EQ(rig.cameras.size(), 2U);
  EXPECT_EQ(rig.cameras[1].name, "right");
  EXPECT_THROW(import_opencv({place.file("left.yml"), place.file("left.yml")}, 1), Error);
  EXPECT_THROW(import_opencv({place.file("none.yml")}, 1), Error);
  EXPECT_THROW(import_opencv({}, 1), Error);
}

TEST(OpencvYaml, says_what_is_wrong_with_a_file) {
  const auto says = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_TRUE(text.starts_with("left.yml: ")) << text;
  };
  const auto without = [](const std::string& what) {
    std::string text = kYaml;
    return text.replace(text.find(what), what.size(), "other");
  };
  says(refusal("rubbish"), "OpenCV");
  says(refusal(""), "OpenCV");
  says(refusal("%YAML:1.0\n---\nimage_width: [ 1, \n"), "OpenCV");
  says(refusal(without("camera_matrix")), "has no camera_matrix");
  says(refusal(without("image_width")), "has no image_width");
  says(refusal(kYaml + "R: [ 1, 0, 0, 0, 1, 0, 0, 0, 1 ]\n"), "has R and no T");
  says(refusal(kYaml + "R: [ 1, 0, 0, 0 ]\nT: [ 0, 0, 1 ]\n"), "rotation has 4 numbers");
  says(refusal(kYaml + "R: [ 2, 0, 0, 0, 1, 0, 0, 0, 1 ]\nT: [ 0, 0, 1 ]\n"), "the rotation is none");
  says(refusal(kYaml + "distortion_model: equidistant\n"), "fisheye");
  std::string rational = kYaml;
  rational.replace(rational.find("0.3 ]"), 5, "0.3, 0.4 ]");
  says(refusal(rational), "coefficient 6 is 0.4");
  std::string sheared = kYaml;
  sheared.replace(sheared.find("0., 0., 1. ]"), 12, "0., 1., 1. ]");
  says(refusal(sheared), "camera matrix is not");
}

}  // namespace
}  // namespace rptv
