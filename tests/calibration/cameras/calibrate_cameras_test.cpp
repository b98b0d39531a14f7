// SPDX-License-Identifier: MIT
// Rigs that are known, from what their cameras see of a target; and sets that no rig can be made of.
#include "calibration/cameras/calibrate_cameras.hpp"

#include <gmock/gmock.h>

#include "tests/calibration/cameras/board_rig.hpp"

namespace rptv {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

void expect_poses(const BoardRig& rig, const Bundle& found, double angle_deg_, double distance_mm) {
  for (std::size_t c = 0; c < rig.set.cameras.size(); ++c) {
    const CameraPose truth = rig.from_first(c);
    EXPECT_LT(angle_deg(found.cameras[c].rotation * transpose(truth.rotation)), angle_deg_) << c;
    EXPECT_LT(norm(inverse(found.cameras[c]).translation_mm - inverse(truth).translation_mm), distance_mm) << c;
  }
}

TEST(CalibrateCameras, finds_lenses_and_poses_of_a_rig) {
  const BoardRig rig(small_board().points());
  const auto found = calibrate_cameras(rig.set, {});
  expect_poses(rig, found.result.bundle, 0.05, 0.2);
  for (std::size_t c = 0; c < 4; ++c) {
    const auto &lens = found.rig.cameras[c].model.intrinsics(), &truth = rig.truth.lenses[c];
    EXPECT_NEAR(lens.fx_px, truth.fx_px, 5 * found.result.lens_sigma[c][0]);
    EXPECT_NEAR(lens.cy_px, truth.cy_px, 5 * found.result.lens_sigma[c][3]);
    EXPECT_NEAR(lens.k1, truth.k1, 5 * found.result.lens_sigma[c][4]);
    EXPECT_EQ(lens.k3, 0);
  }
  EXPECT_NEAR(found.result.sigma_px, 0.005, 0.0005);
  EXPECT_NEAR(found.result.rms_px, 0.005 * std::sqrt(2), 0.0005);
  EXPECT_TRUE(found.dropped.empty());
  EXPECT_EQ(found.graph.pairs.size(), 6U);
}

TEST(CalibrateCameras, is_exact_without_noise) {
  const BoardRig rig(small_board().points(), 8, 0);
  expect_poses(rig, calibrate_cameras(rig.set, {}).result.bundle, 1e-5, 1e-4);
}

TEST(CalibrateCameras, calibrates_with_points_of_a_cube) {
  std::vector<Point3> cube;
  for (double x : {-40.0, 0.0, 40.0})
    for (double y : {-40.0, 0.0, 40.0})
      for (double z : {-40.0, 5.0, 40.0}) cube.push_back({x + 0.1 * z, y, z});
  const BoardRig rig(cube, 4), one_view(cube, 1, 0.002);
  expect_poses(rig, calibrate_cameras(rig.set, {}).result.bundle, 0.05, 0.5);
  expect_poses(one_view, calibrate_cameras(one_view.set, {}).result.bundle, 0.1, 1);
}

TEST(CalibrateCameras, puts_the_frame_on_the_board_of_a_view) {
  const BoardRig rig(small_board().points(), 6, 0.002);
  CameraCalibrationOptions options;
  options.world_view = 3;
  const auto found = calibrate_cameras(rig.set, options);
  EXPECT_EQ(norm(found.result.bundle.targets[3]->translation_mm), 0);
  const CameraPose truth = after(rig.truth.cameras[2], *rig.truth.targets[3]);
  EXPECT_LT(norm(inverse(found.rig.cameras[2].model.pose()).translation_mm - inverse(truth).translation_mm), 0.3);
}

TEST(CalibrateCameras, drops_and_reports_a_view_that_does_not_fit) {
  BoardRig rig(small_board().points());
  for (auto& seen : rig.image(1, 4).seen) seen.pixel[0] += 2 * std::sin(seen.pixel[1] / 20);  // a bent board
  const auto found = calibrate_cameras(rig.set, {});
  ASSERT_EQ(found.dropped.size(), 1U);
  EXPECT_EQ(found.dropped[0].camera, 1U);
  EXPECT_EQ(found.dropped[0].view, 4U);
  EXPECT_THAT(found.dropped[0].reason, HasSubstr("median"));
  expect_poses(rig, found.result.bundle, 0.05, 0.2);
}

TEST(CalibrateCameras, weighs_single_wrong_points_down) {
  BoardRig rig(small_board().points());
  for (std::size_t v = 0; v < 10; v += 3) rig.image(2, v).seen[5].pixel[1] += 1;
  const auto found = calibrate_cameras(rig.set, {});
  EXPECT_EQ(found.result.outliers, 4U);
  expect_poses(rig, found.result.bundle, 0.05, 0.2);
}

TEST(CalibrateCameras, finds_the_glass_of_a_tank) {
  // In the first camera's frame the window is tilted, 800 mm away; the target is in water.
  const BoardRig in_air(small_board().points(), 1);
  const CameraPose& first = in_air.truth.cameras[0];
  const RefractiveStack in_rig{{0, 0, -1}, {1.0}, {{130, {1.46}}, {120, {1.33}}}};
  const BoardRig rig(small_board().points(), 8, 0.01, 0.6, in_rig);
  Bundle moved = rig.truth;
  moved = in_frame(moved, inverse(first));
  CameraCalibrationOptions options;
  options.stack = moved.stack;
  for (auto& interface : options.stack.interfaces) interface.position_mm += 4;  // as a ruler has it
  options.fit_stack = true;
  const auto fitted = calibrate_cameras(rig.set, options);
  EXPECT_NEAR(fitted.result.bundle.stack.interfaces[0].position_mm, moved.stack.interfaces[0].position_mm, 2);
  EXPECT_LT(fitted.result.sigma_px, 0.0102);
  expect_poses(rig, fitted.result.bundle, 0.1, 2);
}

TEST(CalibrateCameras, takes_a_window_of_each_camera) {
  std::vector<RefractiveStack> windows;
  for (const double distance_mm : {700.0, 720.0, 690.0, 735.0})
    windows.push_back({{0, 0, -1}, {1.0}, {{-distance_mm, {1.46}}, {-distance_mm - 8, {1.33}}}});
  const BoardRig rig(small_board().points(), 8, 0.01, 0.6, {}, windows);
  CameraCalibrationOptions options;
  options.windows = windows;
  const auto told = calibrate_cameras(rig.set, options);
  EXPECT_LT(told.result.sigma_px, 0.0102);
  expect_poses(rig, told.result.bundle, 0.1, 2);
  EXPECT_EQ(told.result.bundle.windows[2].interfaces[0].position_mm, -690);
  const CameraModel& third = told.rig.cameras[2].model;
  EXPECT_LT(norm(third.stack().normal + third.pose().rotation[2]), 1e-12) << "across its axis";

  options.windows.clear(), options.stack = windows[0];
  EXPECT_GT(calibrate_cameras(rig.set, options).result.sigma_px, 2 * told.result.sigma_px) << "one for all";
}

std::string why_not(const BoardSet& set) {
  return refusal_of([&] { calibrate_cameras(set, {}); });
}

TEST(CalibrateCameras, names_the_cameras_whose_images_are_swapped_in_a_view) {
  BoardRig rig(small_board().points());
  std::swap(rig.image(1, 5).seen, rig.image(2, 5).seen);
  EXPECT_THAT(why_not(rig.set), HasSubstr("cameras cam1 and cam2 are swapped in view 5:"));
}

TEST(CalibrateCameras, names_the_camera_whose_images_another_one_has) {
  BoardRig rig(small_board().points());
  for (std::size_t v = 0; v < 10; ++v) rig.image(3, v).seen = rig.image(0, v).seen;
  EXPECT_THAT(why_not(rig.set), HasSubstr("cameras cam0 and cam3 stand at the same place"));
}

TEST(CalibrateCameras, names_a_camera_that_saw_the_target_at_another_time) {
  BoardRig rig(small_board().points());
  for (std::size_t v = 0; v + 1 < 10; ++v) rig.image(3, v).seen = rig.image(3, v + 1).seen;  // one view late
  EXPECT_THAT(why_not(rig.set), AllOf(HasSubstr("cam3"), HasSubstr("contradict each other in view")));
}

TEST(CalibrateCameras, names_a_camera_that_shares_too_few_views) {
  BoardRig rig(small_board().points(), 12);
  for (std::size_t v = 0; v < 12; ++v) rig.image(v < 6 ? 0 : 3, v).seen.clear();
  for (std::size_t v = 0; v < 10; ++v) rig.image(v < 8 ? 1 : 2, v).seen.clear();
  EXPECT_THAT(why_not(rig.set), HasSubstr("camera cam1 sees the target together with 1 other camera in 3"));
}

TEST(CalibrateCameras, refuses_views_in_one_orientation) {
  const BoardRig rig(small_board().points(), 10, 0.005, 0.01);
  EXPECT_THAT(why_not(rig.set), AllOf(HasSubstr("camera cam0"), HasSubstr("one orientation only"), HasSubstr("tilt")));
}

TEST(CalibrateCameras, refuses_too_few_views) {
  const BoardRig rig(small_board().points(), 2);
  EXPECT_THAT(why_not(rig.set), AllOf(HasSubstr("camera cam0"), HasSubstr("2 views"), HasSubstr("at least 3")));
}

}  // namespace
}  // namespace rptv
