// SPDX-License-Identifier: MIT
// A rig that has shifted is put right by a rod of known length; rods that cannot serve are refused.
#include "calibration/cameras/wand.hpp"

#include <gmock/gmock.h>

#include "calibration/cameras/rig_accuracy.hpp"
#include "tests/calibration/cameras/board_rig.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;

constexpr double kLength_mm = 100;

/// The rig after somebody leaned on it: all cameras but the first are turned and shifted a little.
Rig leaned_on(const BoardRig& rig, double turn_rad, double shift_mm) {
  Rig start;
  for (std::size_t c = 0; c < rig.truth.cameras.size(); ++c) {
    CameraPose pose = rig.truth.cameras[c];
    if (c > 0) {
      const CameraPose turned = looking_at({0, 0, 0}, {std::sin(turn_rad), 0, std::cos(turn_rad)}, 0);
      pose = after(CameraPose{turned.rotation, {shift_mm, -shift_mm, 0}}, pose);
    }
    start.cameras.push_back({rig.set.cameras[c].name, CameraModel(rig.truth.lenses[c], pose)});
  }
  return start;
}

BoardRig waved_rod() { return BoardRig({{-kLength_mm / 2, 0, 0}, {kLength_mm / 2, 0, 0}}, 60, 0.05, 0.8); }

TEST(Wand, puts_a_rig_right_that_was_leaned_on) {
  const BoardRig rig = waved_rod();
  const Rig start = leaned_on(rig, 0.002, 1);
  const auto found = calibrate_with_wand(start, rig.set, kLength_mm, false);
  EXPECT_GT(found.rods, 50U);
  EXPECT_GT(found.before_rms_mm, 3 * found.rms_mm);
  EXPECT_LT(found.rms_mm, 0.05);
  EXPECT_NEAR(found.result.sigma_px, 0.05, 0.01);
  for (std::size_t c = 0; c < 4; ++c) {
    const CameraPose &pose = found.rig.cameras[c].model.pose(), &truth = rig.truth.cameras[c];
    EXPECT_LT(angle_deg(pose.rotation * transpose(truth.rotation)), 0.02) << c;
    EXPECT_LT(norm(inverse(pose).translation_mm - inverse(truth).translation_mm), 0.3) << c;
  }
}

TEST(Wand, says_why_not) {
  const BoardRig rig = waved_rod();
  const Rig start = leaned_on(rig, 0, 0);
  const auto why_not = [&](const BoardSet& seen, double length_mm) {
    return refusal_of([&] { calibrate_with_wand(start, seen, length_mm, false); });
  };
  EXPECT_THAT(why_not(rig.set, 130), HasSubstr("the rod is 100."));
  BoardSet few = rig.set;
  std::erase_if(few.images, [](const BoardView& image) { return image.view > 5; });
  EXPECT_THAT(why_not(few, kLength_mm), HasSubstr("in 6 views"));
  BoardSet blind = rig.set;
  std::erase_if(blind.images, [](const BoardView& image) { return image.camera == 2 && image.view > 2; });
  EXPECT_THAT(why_not(blind, kLength_mm), HasSubstr("camera cam2 sees 6 ends"));
}

}  // namespace
}  // namespace rptv
