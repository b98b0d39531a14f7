// SPDX-License-Identifier: MIT
// Cameras found again from points of known place, through glass and water, with noise, outliers and too little.
#include "calibration/cameras/known_points.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/error.hpp"
#include "tests/calibration/cameras/sample_cameras.hpp"

namespace rptv {
namespace {

const RefractiveStack kTank{{0, 0, 1}, {1.0}, {{131, {1.46}}, {125, {1.33}}}};

CameraModel true_camera(double x_mm) {
  CameraIntrinsics lens{1280, 1024, 5800, 5790, 639.5, 511.5};
  lens.k1 = -0.3, lens.p1 = 2e-3, lens.p2 = -1e-3;
  return CameraModel(lens, looking_at({x_mm, 40, 620}, {0, 0, 0}, 0.02), kTank);
}

/// Turned by some mrad, moved by some mm, another focal length, no distortion: 30 to 60 px off.
CameraModel start_camera(double x_mm) {
  CameraIntrinsics lens = true_camera(x_mm).intrinsics();
  lens.fx_px *= 1.01, lens.fy_px *= 1.01, lens.k1 = lens.p1 = lens.p2 = 0;
  return CameraModel(lens, looking_at({x_mm + 4, 37, 612}, {2, -1, 0}, 0.025), kTank);
}

/// 5 mm grid on planes at the given heights, seen with noise.
std::vector<KnownPoint> seen_by(const CameraModel& model, std::size_t camera, const std::vector<double>& heights_mm,
                                double noise_px) {
  std::mt19937_64 random(5 + camera);
  std::normal_distribution<double> normal;
  std::vector<KnownPoint> points;
  for (const double z : heights_mm)
    for (double x = -40; x <= 40; x += 10)
      for (double y = -30; y <= 30; y += 10) {
        const Pixel at = *model.project({x, y, z});
        points.push_back({camera, {x, y, z}, {at[0] + noise_px * normal(random), at[1] + noise_px * normal(random)}});
      }
  return points;
}

std::string refusal(const Rig& start, const std::vector<KnownPoint>& points, CameraFreedom freedom) {
  try {
    fit_known_points(start, points, freedom, "dots.csv");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_data);
    return error.what();
  }
  return "";
}

TEST(KnownPoints, find_every_camera_through_the_glass_again) {
  const Rig truth{{{"left", true_camera(-150)}, {"right", true_camera(150)}}};
  const Rig start{{{"left", start_camera(-150)}, {"right", start_camera(150)}}};
  auto points = seen_by(truth.cameras[0].model, 0, {-10, 10}, 0);
  const auto more = seen_by(truth.cameras[1].model, 1, {-10, 10}, 0);
  points.insert(points.end(), more.begin(), more.end());
  const auto fit = fit_known_points(start, points, CameraFreedom::distortion, "dots.csv");
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_GT(fit.cameras[k].before_rms_px, 20);
    EXPECT_LT(fit.cameras[k].rms_px, 1e-4);
    EXPECT_LT(norm(fit.rig.cameras[k].model.centre_mm() - truth.cameras[k].model.centre_mm()), 0.01);
    EXPECT_NEAR(fit.rig.cameras[k].model.intrinsics().k1, -0.3, 1e-3);
  }
}

TEST(KnownPoints, noise_stays_noise_and_outliers_are_left_out_and_counted) {
  const Rig start{{{"left", start_camera(-150)}}};
  auto points = seen_by(true_camera(-150), 0, {-15, 0, 15}, 0.1);
  const std::size_t honest = points.size();
  for (std::size_t i = 3; i < honest; i += 31) points[i].pixel[0] += 25;
  const auto fit = fit_known_points(start, points, CameraFreedom::distortion, "dots.csv");
  EXPECT_NEAR(fit.cameras[0].rms_px, 0.1 * std::sqrt(2), 0.02);
  EXPECT_EQ(fit.cameras[0].points + fit.cameras[0].left_out, honest);
  EXPECT_NEAR(static_cast<double>(fit.cameras[0].left_out), static_cast<double>(honest / 31 + 1), 3);
  const Pixel expected = *true_camera(-150).project({5, 5, 5}), found = *fit.rig.cameras[0].model.project({5, 5, 5});
  EXPECT_NEAR(found[0], expected[0], 0.05);
  EXPECT_NEAR(found[1], expected[1], 0.05);
}

TEST(KnownPoints, a_camera_without_points_stays) {
  const Rig start{{{"left", true_camera(-150)}, {"right", true_camera(150)}}};
  const auto fit = fit_known_points(start, seen_by(true_camera(150), 1, {0, 10}, 0.1), CameraFreedom::pose, "dots.csv");
  EXPECT_EQ(fit.rig.cameras[0].model.pose(), start.cameras[0].model.pose());
  EXPECT_EQ(fit.cameras[0].points, 0U);
}

TEST(KnownPoints, say_what_they_cannot_tell) {
  const auto says = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_TRUE(text.starts_with("dots.csv: camera 'left' ")) << text;
  };
  const CameraIntrinsics plain{1280, 1024, 5800, 5800, 639.5, 511.5};
  const CameraModel facing(plain, looking_at({0, 0, 620}, {0, 0, 0}, 0));  // a plane tells focal length times nearness
  const Rig start{{{"left", facing}}};
  says(refusal(start, seen_by(facing, 0, {0}, 0), CameraFreedom::focal), "do not determine it");
  auto few = seen_by(facing, 0, {0}, 0);
  few.resize(6);
  says(refusal(start, few, CameraFreedom::focal), "has 6 points left; give at least 7");
  says(refusal(start, {{0, {0, 0, 700}, {0, 0}}}, CameraFreedom::pose), "cannot see all its points");
}

TEST(KnownPoints, are_read_by_the_cameras_names) {
  const Rig rig{{{"left", true_camera(-150)}, {"right", true_camera(150)}}};
  const auto points = parse_known_points("camera,x,y,z,column,row\nright,1,2,3,4,5\n", "dots.csv", rig);
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0].camera, 1U);
  EXPECT_EQ(points[0].position_mm, (Point3{1, 2, 3}));
  EXPECT_EQ(points[0].pixel, (Pixel{4, 5}));
  try {
    parse_known_points("camera,x,y,z,column,row\nmiddle,1,2,3,4,5\n", "dots.csv", rig);
    FAIL() << "a camera that the rig has not was taken";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "dots.csv:2: the rig has no camera 'middle'; name those of the rig");
  }
}

}  // namespace
}  // namespace rptv
