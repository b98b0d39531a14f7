// SPDX-License-Identifier: MIT
// The residuals of a bundle adjustment, with their derivatives, as Ceres takes them.
#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <algorithm>
#include <span>

#include "calibration/cameras/bundle_projection.hpp"

namespace rptv {

/// Pixels from where a point was seen to where the parameters (lens, camera, target, wall) put it.
class SeenPointCost : public ceres::SizedCostFunction<2, 9, 6, 6, 3> {
 public:
  /// `like`: the projection, but for its parameters.
  SeenPointCost(const Point3& point_mm, const Pixel& seen, const BundleProjection& like)
      : point_mm_(point_mm),
        seen_(seen),
        stack_(like.stack),
        distortion_(like.distortion),
        in_camera_(like.in_camera) {}

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const BundleProjection projection{std::span<const double, 9>(parameters[0], 9),
                                      std::span<const double, 6>(parameters[1], 6),
                                      std::span<const double, 6>(parameters[2], 6),
                                      stack_,
                                      std::span<const double, 3>(parameters[3], 3),
                                      distortion_,
                                      in_camera_};
    ProjectionDerivatives derivatives;
    Pixel at;
    if (!projection.project(point_mm_, at, jacobians != nullptr ? &derivatives : nullptr)) return false;
    residuals[0] = at[0] - seen_[0], residuals[1] = at[1] - seen_[1];
    if (jacobians == nullptr) return true;
    const auto give = [&](int block, const auto& values) {
      if (jacobians[block] != nullptr) std::copy(values.begin(), values.end(), jacobians[block]);
    };
    give(0, derivatives.by_lens), give(1, derivatives.by_camera), give(2, derivatives.by_target);
    give(3, derivatives.by_stack);
    return true;
  }

 private:
  Point3 point_mm_;
  Pixel seen_;
  const RefractiveStack* stack_;
  const BrownDistortion* distortion_;
  bool in_camera_;
};

/// How far two targets (first, second) are from their known distance, as pixels.
class RodCost : public ceres::SizedCostFunction<1, 6, 6> {
 public:
  static constexpr double kPixel_px = 0.1, kRodError = 1e-4;  // what a length weighs

  explicit RodCost(double length_mm) : length_mm_(length_mm), weight_(kPixel_px / (kRodError * length_mm)) {}

  bool Evaluate(const double* const* ends, double* residual, double** jacobians) const override {
    const Eigen::Map<const Eigen::Vector3d> first(ends[0] + 3), second(ends[1] + 3);
    const Eigen::Vector3d along = second - first;
    const double length = along.norm();
    if (!(length > 0)) return false;
    residual[0] = weight_ * (length - length_mm_);
    for (int end = 0; jacobians != nullptr && end < 2; ++end) {
      if (jacobians[end] == nullptr) continue;
      Eigen::Map<Eigen::Matrix<double, 1, 6>> row(jacobians[end]);
      row << 0, 0, 0, (end == 0 ? -weight_ : weight_) / length * along.transpose();
    }
    return true;
  }

 private:
  double length_mm_, weight_;
};

}  // namespace rptv
