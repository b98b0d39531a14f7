// SPDX-License-Identifier: MIT
// Projection, its derivative and sight rays, step by step from the rig's frame to the sensor.
#include "calibration/cameras/camera_model.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "calibration/space_algebra.hpp"
#include "core/error.hpp"

namespace rptv {

namespace {
constexpr double kRotationTolerance = 1e-6;
constexpr int kLargestSide = 65536;

Point3 centre_of(const CameraIntrinsics& lens, const CameraPose& pose, const std::string& origin) {
  const auto refuse = [&](const std::string& text) { throw Error(ExitCode::configuration, origin + ": " + text); };
  if (lens.width_px < 1 || lens.height_px < 1 || lens.width_px > kLargestSide || lens.height_px > kLargestSide)
    refuse(fmt::format("an image of {}x{} px is not within 1 to {}; give the calibrated images' size", lens.width_px,
                       lens.height_px, kLargestSide));
  if (!(lens.fx_px > 0) || !(lens.fy_px > 0))
    refuse(fmt::format("focal lengths {} and {} px are not above 0; mend fx_px and fy_px", lens.fx_px, lens.fy_px));
  for (const double value :
       {lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px, lens.skew_px, lens.k1, lens.k2, lens.k3, lens.p1, lens.p2,
        lens.offset_x, lens.offset_y, pose.translation_mm[0], pose.translation_mm[1], pose.translation_mm[2]})
    if (!std::isfinite(value)) refuse(fmt::format("a value is {}; every number must be finite", value));
  const Matrix3 square = pose.rotation * transpose(pose.rotation);
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column)
      if (const double off = square[row][column] - (row == column ? 1 : 0); !(std::abs(off) < kRotationTolerance))
        refuse(
            fmt::format("the rotation is none: rows {} and {} are off unit length or right angles by {:.3g}; give 9 "
                        "numbers, row by row, to 7 digits",
                        row + 1, column + 1, off));
  if (determinant(pose.rotation) < 0)
    refuse("the rotation mirrors: its determinant is -1; check the order and the signs of its rows");
  return -1.0 * (inverse(pose.rotation) * pose.translation_mm);
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr SightRay kNoRay{{kNan, kNan, kNan}, {kNan, kNan, kNan}};
}  // namespace

CameraModel::CameraModel(const CameraIntrinsics& intrinsics, const CameraPose& pose, const RefractiveStack& stack,
                         const std::string& origin)
    : intrinsics_(intrinsics), pose_(pose), stack_(stack), path_(centre_of(intrinsics, pose, origin), stack, origin) {
  distortion_ = {intrinsics.k1, intrinsics.k2, intrinsics.k3, intrinsics.p1, intrinsics.p2};
  to_rig_ = inverse(pose.rotation);
}

Pixel CameraModel::to_pixel(const Pixel& distorted) const noexcept {
  const auto& lens = intrinsics_;
  return {lens.fx_px * distorted[0] + lens.skew_px * distorted[1] + lens.cx_px, lens.fy_px * distorted[1] + lens.cy_px};
}

std::optional<Pixel> CameraModel::project(const Point3& point_mm) const noexcept {
  const auto direction = path_.direction_to(point_mm);
  if (!direction) return std::nullopt;
  const Point3 seen = pose_.rotation * *direction;
  if (!(seen[2] > 0)) return std::nullopt;
  const auto distorted =
      distortion_.distort({seen[0] / seen[2] + intrinsics_.offset_x, seen[1] / seen[2] + intrinsics_.offset_y});
  if (!distorted) return std::nullopt;
  return to_pixel(*distorted);
}

std::optional<Pixel> CameraModel::project(const Point3& point_mm, PixelJacobian& jacobian) const noexcept {
  const auto direction = path_.derivative_to(point_mm);
  if (!direction) return std::nullopt;
  const Point3 seen = pose_.rotation * direction->direction;
  if (!(seen[2] > 0)) return std::nullopt;
  const double x = seen[0] / seen[2], y = seen[1] / seen[2];
  const Pixel ideal{x + intrinsics_.offset_x, y + intrinsics_.offset_y};
  const auto distorted = distortion_.distort(ideal);
  if (!distorted) return std::nullopt;
  const Matrix3 turned = pose_.rotation * direction->derivative;
  const Matrix2 bend = distortion_.derivative(ideal);
  const auto& lens = intrinsics_;
  for (std::size_t k = 0; k < 3; ++k) {
    const double dx = (turned[0][k] - x * turned[2][k]) / seen[2], dy = (turned[1][k] - y * turned[2][k]) / seen[2];
    const double bent_x = bend[0][0] * dx + bend[0][1] * dy, bent_y = bend[1][0] * dx + bend[1][1] * dy;
    jacobian[0][k] = lens.fx_px * bent_x + lens.skew_px * bent_y;
    jacobian[1][k] = lens.fy_px * bent_y;
  }
  return to_pixel(*distorted);
}

SightRay CameraModel::ray(const Pixel& pixel) const noexcept {
  const auto& lens = intrinsics_;
  const double y = (pixel[1] - lens.cy_px) / lens.fy_px;
  const auto ideal = distortion_.undistort({(pixel[0] - lens.cx_px - lens.skew_px * y) / lens.fx_px, y});
  if (!ideal) return kNoRay;
  const Point3 towards = to_rig_ * Point3{(*ideal)[0] - lens.offset_x, (*ideal)[1] - lens.offset_y, 1};
  const auto light = path_.follow((1 / norm(towards)) * towards);
  return light.value_or(kNoRay);
}

bool CameraModel::in_image(const Pixel& pixel) const noexcept {
  return pixel[0] >= -0.5 && pixel[0] < intrinsics_.width_px - 0.5 && pixel[1] >= -0.5 &&
         pixel[1] < intrinsics_.height_px - 0.5;
}

}  // namespace rptv
