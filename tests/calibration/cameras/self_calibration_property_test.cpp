// SPDX-License-Identifier: MIT
// Whatever cameras are pushed, exact disparities lead back to cameras that agree.
#include <gmock/gmock.h>

#include "calibration/cameras/rig_accuracy.hpp"
#include "calibration/cameras/self_calibration.hpp"
#include "tests/calibration/cameras/board_rig.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;

const DisparityGrid kGrid{{-60, -60, -60}, {60, 60, 60}, {3, 3, 2}};

Rig true_rig() {
  const BoardRig board({{0, 0, 0}}, 1);
  Rig rig;
  for (std::size_t c = 0; c < 4; ++c)
    rig.cameras.push_back({board.set.cameras[c].name, CameraModel(board.truth.lenses[c], board.truth.cameras[c])});
  return rig;
}

/// Turned and shifted by up to about 4 px each way.
CameraModel drawn_push(const CameraModel& model) {
  const Point3 aim{*real(-4, 4) / 3000, *real(-4, 4) / 3000, 1};
  const CameraPose turn = looking_at({0, 0, 0}, aim, *real(-0.004, 0.004));
  const Point3 shift{*real(-1, 1), *real(-1, 1), *real(-2, 2)};
  return CameraModel(model.intrinsics(), after(CameraPose{turn.rotation, shift}, model.pose()));
}

/// Disparities of one particle in the middle of each part, many times.
void gather(const Rig& rig, const Rig& truth, DisparityMaps& maps) {
  for (std::size_t part = 0; part < kGrid.size(); ++part) {
    std::vector<Sighting> seen;
    for (std::size_t c = 0; c < rig.cameras.size(); ++c)
      seen.push_back({&rig.cameras[c].model, *truth.cameras[c].model.project(kGrid.centre_mm(part))});
    const auto at = triangulate(seen);
    if (!at) continue;
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
      const Pixel pixel = *rig.cameras[c].model.project(*at);
      for (int i = 0; i < 40; ++i) maps.add(c, *at, {pixel[0] - seen[c].pixel[0], pixel[1] - seen[c].pixel[1]});
    }
  }
}

TEST(SelfCalibrationProperty, pushed_cameras_agree_again_after_three_rounds) {
  const Rig truth = true_rig();
  EXPECT_TRUE(rc::check([&] {
    Rig start = truth;
    for (auto& camera : start.cameras) camera.model = drawn_push(camera.model);
    const auto found = self_calibrate(
        start, kGrid, {CameraFreedom::pose, 12}, [&](const Rig& rig, DisparityMaps& maps) { gather(rig, truth, maps); },
        "rig.toml");
    for (const auto& camera : found.after) {
      RC_ASSERT(camera.parts == kGrid.size());
      RC_ASSERT(camera.worst_px < 0.01);
    }
  }));
}

TEST(SelfCalibrationProperty, cameras_that_did_not_move_stay) {
  const Rig truth = true_rig();
  EXPECT_TRUE(rc::check([&] {
    Rig start = truth;
    auto& pushed = start.cameras[*rc::gen::inRange<std::size_t>(0, 4)].model;
    pushed = drawn_push(pushed);
    const auto found = self_calibrate(
        start, kGrid, {CameraFreedom::pose, 12}, [&](const Rig& rig, DisparityMaps& maps) { gather(rig, truth, maps); },
        "rig.toml");
    for (std::size_t c = 0; c < 4; ++c) {
      const CameraPose &pose = found.rig.cameras[c].model.pose(), &was = truth.cameras[c].model.pose();
      RC_ASSERT(angle_deg(pose.rotation * transpose(was.rotation)) < 0.002);
      RC_ASSERT(norm(inverse(pose).translation_mm - inverse(was).translation_mm) < 0.03);
    }
  }));
}

TEST(SelfCalibrationProperty, focal_lengths_come_back_where_they_are_free) {
  const Rig truth = true_rig();
  Rig start = truth;
  CameraIntrinsics lens = truth.cameras[1].model.intrinsics();
  lens.fx_px *= 1.004, lens.fy_px *= 1.004;
  start.cameras[1].model = CameraModel(lens, truth.cameras[1].model.pose());
  const auto found = self_calibrate(
      start, kGrid, {CameraFreedom::focal, 12}, [&](const Rig& rig, DisparityMaps& maps) { gather(rig, truth, maps); },
      "rig.toml");
  for (const auto& camera : found.after) EXPECT_LT(camera.worst_px, 0.01);
  EXPECT_NEAR(found.rig.cameras[1].model.intrinsics().fx_px, truth.cameras[1].model.intrinsics().fx_px, 1);
}

TEST(SelfCalibrationProperty, a_rig_that_gets_no_better_is_refused) {
  const Rig truth = true_rig();
  const auto why_not = [&](const GatherDisparities& gathered) {
    return refusal_of([&] { self_calibrate(truth, kGrid, {}, gathered, "rig.toml"); });
  };
  EXPECT_THAT(why_not([&](const Rig& rig, DisparityMaps& maps) {
                for (std::size_t part = 0; part < kGrid.size(); ++part)
                  for (std::size_t c = 0; c < rig.cameras.size(); ++c)
                    for (int i = 0; i < 40; ++i) maps.add(c, kGrid.centre_mm(part), {0.3, 0});
              }),
              HasSubstr("keep this rig"));
  EXPECT_THAT(why_not([](const Rig&, DisparityMaps&) {}),
              HasSubstr("camera 'cam0' has a clear disparity within 1 px in "
                        "0 of 18 parts of the volume and needs 6"));
}

}  // namespace
}  // namespace rptv
