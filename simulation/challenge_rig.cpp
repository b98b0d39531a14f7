// SPDX-License-Identifier: MIT
// Poses from angles, and what follows from the sensor.
#include "simulation/challenge_rig.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibration/space_algebra.hpp"

namespace rptv {

namespace {

constexpr double kDistanceMm = 600, kFocalPx = 10000;
constexpr int kWidthPx = 1920, kHeightPx = 1200;

/// Looks at the origin from `distance`, turned about y, then up or down; rows along -y of the rig.
CameraPose pose_at(double about_y_deg, double about_x_deg) {
  const double a = about_y_deg * std::numbers::pi / 180, b = about_x_deg * std::numbers::pi / 180;
  const Point3 from{std::sin(a) * std::cos(b), std::sin(b), std::cos(a) * std::cos(b)};
  const Point3 forward = -1.0 * from;
  const Point3 beside = cross({0, -1, 0}, forward);
  const Point3 right = (1 / norm(beside)) * beside;
  return {{{right, cross(forward, right), forward}}, {0, 0, kDistanceMm}};
}

}  // namespace

Rig challenge_rig(double sensor_part) {
  const auto side = [&](int full) { return std::max(1, static_cast<int>(std::lround(sensor_part * full))); };
  CameraIntrinsics lens{side(kWidthPx), side(kHeightPx), kFocalPx, kFocalPx};
  lens.cx_px = 0.5 * (lens.width_px - 1), lens.cy_px = 0.5 * (lens.height_px - 1);
  Rig rig;
  for (const double about_y : {-30.0, 30.0})
    for (const double about_x : {-10.0, 10.0})
      rig.cameras.push_back({"cam" + std::to_string(rig.cameras.size()), CameraModel(lens, pose_at(about_y, about_x))});
  return rig;
}

Rig rig_of(const ScenarioSettings& scenario) {
  return scenario.views.rig == "lpt_challenge" ? challenge_rig(scenario.views.sensor_part)
                                               : read_rig(scenario.views.rig);
}

ScenarioSettings fitted_to_rig(ScenarioSettings scenario, const Rig& rig) {
  const auto& lens = rig.cameras.front().model.intrinsics();
  scenario.camera.width_px = lens.width_px, scenario.camera.height_px = lens.height_px;
  if (scenario.views.rig == "lpt_challenge") {
    scenario.seeding.volume_x_mm *= scenario.views.sensor_part;
    scenario.seeding.volume_y_mm *= scenario.views.sensor_part;
  }
  if (scenario.views.per_pixel > 0)
    scenario.seeding.particles = std::llround(scenario.views.per_pixel * lens.width_px * lens.height_px);
  return scenario;
}

}  // namespace rptv
