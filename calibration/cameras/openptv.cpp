// SPDX-License-Identifier: MIT
// OpenPTV's conventions against the rig's: axes, units, centre of distortion, media.
#include "calibration/cameras/openptv.hpp"

#include <fmt/format.h>

#include <cmath>

#include "calibration/cameras/centred_distortion.hpp"
#include "calibration/space_algebra.hpp"
#include "core/error.hpp"

namespace rptv {

namespace {

/// OpenPTV's camera looks along its -z with y up; ours along z with y down. The same matrix both ways.
constexpr Matrix3 kAxes{{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};

RefractiveStack stack_of(const OpenptvCamera& camera, const OpenptvSetup& setup, const std::string& origin) {
  if (setup.index_before == 1 && setup.index_glass == 1 && setup.index_behind == 1) return {};
  const double distance_mm = norm(camera.glass_mm);
  if (!(distance_mm > 0))
    throw Error(ExitCode::configuration,
                origin +
                    ": the glass vector is 0, so the glass is nowhere; give its normal, as long as its distance from "
                    "the origin in mm");
  RefractiveStack stack{(1 / distance_mm) * camera.glass_mm, {setup.index_before}, {}};
  if (setup.glass_mm > 0) stack.interfaces.push_back({distance_mm + setup.glass_mm, {setup.index_glass}});
  stack.interfaces.push_back({distance_mm, {setup.index_behind}});
  return stack;
}

/// Glass vector and media of a stack; air gets a glass of index 1 at 1 mm.
void describe_stack(const RefractiveStack& stack, OpenptvCamera& camera, OpenptvSetup& setup,
                    const std::string& origin) {
  const auto& faces = stack.interfaces;
  if (faces.empty()) {
    camera.glass_mm = {0, 0, 1};
    return;
  }
  if (faces.size() > 2)
    throw Error(
        ExitCode::configuration,
        fmt::format("{}: has {} interfaces and OpenPTV has the 2 of one glass; merge them", origin, faces.size()));
  const double inner_mm = faces.back().position_mm;
  if (!(inner_mm > 0))
    throw Error(
        ExitCode::configuration,
        fmt::format("{}: its glass is {} mm before the origin, but the length of OpenPTV's glass vector is that "
                    "distance; move the origin of the rig into the liquid",
                    origin, inner_mm));
  camera.glass_mm = inner_mm * stack.normal;
  setup.index_before = stack.before.index, setup.index_glass = faces.front().behind.index;
  setup.index_behind = faces.back().behind.index, setup.glass_mm = faces.front().position_mm - inner_mm;
}

Point3 angles_of(const Matrix3& d) {
  return {std::atan2(-d[1][2], d[2][2]), std::atan2(d[0][2], std::hypot(d[0][0], d[0][1])),
          std::atan2(-d[0][1], d[0][0])};
}

}  // namespace

CameraModel from_openptv(const OpenptvCamera& c, const OpenptvSetup& setup, OpenptvScale scale,
                         const std::string& origin) {
  const double f = c.cc_mm, rows_scale = scale == OpenptvScale::both ? c.scale_x : 1;
  CameraIntrinsics lens{setup.width_px, setup.height_px};
  lens.fx_px = c.scale_x * f / setup.pixel_x_mm;
  lens.fy_px = rows_scale * std::cos(c.shear_rad) * f / setup.pixel_y_mm;
  lens.skew_px = rows_scale * std::sin(c.shear_rad) * f / setup.pixel_x_mm;  // liboptv's y is up: the sign turns
  lens.cx_px = 0.5 * (setup.width_px - 1), lens.cy_px = 0.5 * (setup.height_px - 1);
  lens.k1 = c.k1 * f * f, lens.k2 = c.k2 * f * f * f * f, lens.k3 = c.k3 * f * f * f * f * f * f;
  lens.p1 = 0 - c.p2 * f, lens.p2 = c.p1 * f;                    // OpenCV numbers them the other way round
  lens.offset_x = c.xh_mm / f, lens.offset_y = 0 - c.yh_mm / f;  // no -0
  CameraPose pose;
  pose.rotation = kAxes * transpose(openptv_rotation(c.angles_rad));
  pose.translation_mm = -1.0 * (pose.rotation * c.position_mm);
  return CameraModel(lens, pose, stack_of(c, setup, origin), origin);
}

OpenptvExport to_openptv(const CameraModel& model, double pixel_mm, OpenptvSetup& setup, const std::string& origin) {
  const auto [lens, roll_rad, worst_px] = centred_distortion(model.intrinsics());
  const double cosine = std::cos(roll_rad), sine = std::sin(roll_rad);
  const Matrix3 roll{{{cosine, -sine, 0}, {sine, cosine, 0}, {0, 0, 1}}};
  const double f = pixel_mm * std::hypot(lens.fy_px, lens.skew_px);
  OpenptvExport result;
  result.worst_px = worst_px;
  OpenptvCamera& c = result.camera;
  c.position_mm = model.centre_mm();
  c.angles_rad = angles_of(transpose(kAxes * (roll * model.pose().rotation)));
  c.cc_mm = f, c.xh_mm = lens.offset_x * f, c.yh_mm = -lens.offset_y * f;
  c.k1 = lens.k1 / (f * f), c.k2 = lens.k2 / (f * f * f * f), c.k3 = lens.k3 / (f * f * f * f * f * f);
  c.p1 = lens.p2 / f, c.p2 = -lens.p1 / f;
  c.scale_x = lens.fx_px * pixel_mm / f, c.shear_rad = std::atan2(lens.skew_px, lens.fy_px);
  setup.width_px = lens.width_px, setup.height_px = lens.height_px;
  setup.pixel_x_mm = setup.pixel_y_mm = pixel_mm;
  describe_stack(model.stack(), c, setup, origin);
  return result;
}

}  // namespace rptv
