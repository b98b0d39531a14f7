// SPDX-License-Identifier: MIT
// How sure a bundle adjustment is of cameras and walls together, and what that makes of a point that they triangulate.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "calibration/cameras/bundle.hpp"
#include "calibration/cameras/bundle_projection.hpp"

namespace rptv {

/// Parameters of an adjustment as it left them, in its own frame, in which the first camera does not move; and their
/// covariance. Parameters count from 0: 9 of each lens, then 6 of each camera's pose, 3 of the wall, 6 of the frame.
struct BundleCovariance {
  std::vector<LensParameters> lenses;
  std::vector<PoseParameters> cameras;
  StackParameters stack{};                   ///< moves the wall of `walls`
  PoseParameters frame{};                    ///< rig's frame → the adjustment's
  Bundle walls;                              ///< its walls and windows, before any move
  std::vector<BrownDistortion> distortions;  ///< of `lenses`
  std::vector<double> values;  ///< size() x size(), rows of what is held are 0; empty: not determined by the images

  std::size_t size() const { return 9 * lenses.size() + 6 * cameras.size() + 3 + 6; }
  std::size_t pose_at(std::size_t camera) const { return 9 * lenses.size() + 6 * camera; }
  std::size_t stack_at() const { return pose_at(cameras.size()); }
  std::size_t frame_at() const { return stack_at() + 3; }
};

/// d(x, y, z)/d(parameter), mm per unit, three rows of size(): how the point that `cameras` (places, two or more)
/// triangulate from fixed pixels moves, in the rig's frame, with each parameter. By the implicit function theorem on
/// the normal equations: -(sum of JᵀJ)⁻¹·(sum of JᵀP), J = d(pixel)/d(point), P = d(pixel)/d(parameter). `point_mm`:
/// rig's frame. None where one does not see it, or rays are parallel. Set-up only, any thread.
std::optional<std::vector<double>> point_by_parameters(const BundleCovariance& covariance,
                                                       std::span<const std::size_t> cameras, const Point3& point_mm);

/// Covariance of that point, mm², by the errors of the calibration alone, the same for all particles there: D·C·Dᵀ of
/// the derivatives D and the covariance C. None also where C is not determined.
std::optional<Matrix3> calibration_covariance_mm2(const BundleCovariance& covariance,
                                                  std::span<const std::size_t> cameras, const Point3& point_mm);

}  // namespace rptv
