// SPDX-License-Identifier: MIT
// Scales of a camera's numbers, and the camera that they make.
#include "calibration/cameras/camera_change.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "calibration/cameras/eigen_space.hpp"
#include "calibration/space_algebra.hpp"

namespace rptv {
namespace {

Matrix3 turned(const Matrix3& rotation, const Point3& turn_rad) {
  const double angle = norm(turn_rad);
  if (angle == 0) return rotation;
  return matrix3_of(Eigen::AngleAxisd(angle, vector_of(turn_rad) / angle).toRotationMatrix()) * rotation;
}

}  // namespace

CameraChange::CameraChange(CameraFreedom freedom, const CameraModel& model, double distance_mm) : model_(&model) {
  const auto& lens = model.intrinsics();
  const double px = 1 / lens.fx_px, radius = 0.5 * std::hypot(lens.width_px, lens.height_px) * px;
  scale_ = {px, px, px / radius, px * distance_mm, px * distance_mm, px / radius * distance_mm};
  if (freedom != CameraFreedom::pose) scale_.push_back(px / radius);
  if (freedom == CameraFreedom::distortion)
    scale_.insert(scale_.end(), {px / std::pow(radius, 3), px / (radius * radius), px / (radius * radius)});
}

CameraModel CameraChange::changed(std::span<const double> by) const {
  const auto at = [&](std::size_t k) { return scale_[k] * by[k]; };
  CameraIntrinsics lens = model_->intrinsics();
  CameraPose pose{turned(model_->pose().rotation, {at(0), at(1), at(2)}),
                  model_->pose().translation_mm + Point3{at(3), at(4), at(5)}};
  if (scale_.size() > 6) lens.fx_px *= 1 + at(6), lens.fy_px *= 1 + at(6);
  if (scale_.size() > 7) lens.k1 += at(7), lens.p1 += at(8), lens.p2 += at(9);
  return CameraModel(lens, pose, model_->stack());
}

}  // namespace rptv
