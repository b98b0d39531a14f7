// SPDX-License-Identifier: MIT
// Cameras for tests: round a tank, behind air, glass and water, or in air; drawn by rapidcheck.
#pragma once

#include <rapidcheck.h>

#include <cmath>

#include "calibration/cameras/camera_model.hpp"
#include "calibration/space_algebra.hpp"

namespace rptv {

/// Any real number of a range, on a grid fine enough to look like one.
inline rc::Gen<double> real(double low, double high) {
  return rc::gen::map(rc::gen::inRange(0, 1000001), [=](int i) { return low + (high - low) * i * 1e-6; });
}

/// A camera at `centre` that looks at `target`, rolled about its axis.
inline CameraPose looking_at(const Point3& centre, const Point3& target, double roll_rad) {
  const Point3 forward = (1 / norm(target - centre)) * (target - centre);
  const Point3 beside = cross(Point3{std::sin(roll_rad), std::cos(roll_rad), 0}, forward);
  const Point3 right = (1 / norm(beside)) * beside;
  const CameraPose turned{{{right, cross(forward, right), forward}}, {}};
  return {turned.rotation, -1.0 * (turned.rotation * centre)};
}

/// 1280 x 1024 px, focal length 5800 px, distorted by up to some pixels at the corners.
inline CameraIntrinsics drawn_lens() {
  CameraIntrinsics lens{1280, 1024, 5800, 5790, *real(600, 680), *real(480, 540), *real(-3, 3)};
  lens.k1 = *real(-0.6, 0.6), lens.k2 = *real(-5, 5), lens.k3 = *real(-20, 20);
  lens.p1 = *real(-0.01, 0.01), lens.p2 = *real(-0.01, 0.01);
  lens.offset_x = *real(-0.01, 0.01), lens.offset_y = *real(-0.01, 0.01);
  return lens;
}

/// Glass of 6 mm with its inner face 125 mm in front of the rig's origin, tilted; water behind.
inline RefractiveStack drawn_tank() {
  const Point3 tilted{*real(-0.2, 0.2), *real(-0.2, 0.2), 1};
  return {(1 / norm(tilted)) * tilted, {1.0}, {{131, {*real(1.3, 1.7)}}, {125, {*real(1.0, 1.5)}}}};
}

inline CameraPose drawn_pose() {
  return looking_at({*real(-250, 250), *real(-250, 250), *real(500, 700)},
                    {*real(-10, 10), *real(-10, 10), *real(-10, 10)}, *real(-3.1, 3.1));
}

inline CameraModel drawn_camera() {
  return CameraModel(drawn_lens(), drawn_pose(), *rc::gen::arbitrary<bool>() ? drawn_tank() : RefractiveStack{});
}

inline Point3 drawn_point() { return {*real(-40, 40), *real(-30, 30), *real(-40, 40)}; }

}  // namespace rptv
