// SPDX-License-Identifier: MIT
// Where a camera sees a point of a target, and how that moves with every parameter that a bundle adjustment turns.
#pragma once

#include <array>
#include <span>

#include "calibration/cameras/camera_model.hpp"

namespace rptv {

/// fx, fy, cx, cy (px), k1, k2, p1, p2, k3.
using LensParameters = std::array<double, 9>;
/// Rotation vector (rad, its length is the angle), then translation (mm): x_outer = R(r)·x_inner + t.
using PoseParameters = std::array<double, 6>;
/// Of a stack of interfaces: turn about two axes across its normal (rad, about the rig's origin), shift along it (mm).
using StackParameters = std::array<double, 3>;

LensParameters parameters_of(const CameraIntrinsics& lens);
PoseParameters parameters_of(const CameraPose& pose);
/// `like` gives the size of the images.
CameraIntrinsics lens_of(std::span<const double, 9> parameters, const CameraIntrinsics& like);
CameraPose pose_of(std::span<const double, 6> parameters);
BrownDistortion distortion_of(std::span<const double, 9> lens);
/// `stack`, turned and shifted.
RefractiveStack moved(const RefractiveStack& stack, std::span<const double, 3> parameters);

/// d(column, row)/d(parameter), row-major.
struct ProjectionDerivatives {
  std::array<double, 2 * 9> by_lens{};
  std::array<double, 2 * 6> by_camera{}, by_target{};
  std::array<double, 2 * 3> by_stack{};
};

/// Parameters of one projection: target → rig by `target`, rig → camera by `camera`, light through `stack`, if any,
/// moved by `stack_move`. A target behind a stack is in its last medium.
struct BundleProjection {
  std::span<const double, 9> lens;
  std::span<const double, 6> camera, target;
  const RefractiveStack* stack = nullptr;
  std::span<const double, 3> stack_move;
  const BrownDistortion* distortion = nullptr;  ///< of `lens`: finding its fold takes longer than all the rest
  bool in_camera = false;  ///< `stack` is in the camera's frame and moves with it, not in the rig's

  /// False where the camera cannot see the point. Derivatives on demand: chain rule through CameraModel's steps,
  /// Snell's law by implicit differentiation.
  bool project(const Point3& point_mm, Pixel& pixel, ProjectionDerivatives* derivatives) const;
};

}  // namespace rptv
