// SPDX-License-Identifier: MIT
// One camera of a rig: pinhole, Brown distortion and plane refractive interfaces, from points to pixels and back.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "calibration/cameras/brown_distortion.hpp"
#include "calibration/cameras/refraction.hpp"
#include "calibration/space.hpp"

namespace rptv {

/// d(column, row)/d(x, y, z), px per mm.
using PixelJacobian = std::array<std::array<double, 3>, 2>;

/// Lens and sensor. With x, y in focal lengths from the optical axis, (x', y') = distorted(x + offset_x, y + offset_y),
/// column = fx·x' + skew·y' + cx and row = fy·y' + cy: c is the centre of the distortion.
struct CameraIntrinsics {
  int width_px = 0, height_px = 0;
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0, skew_px = 0;
  double k1 = 0, k2 = 0, k3 = 0, p1 = 0, p2 = 0;  ///< Brown, as OpenCV has them
  double offset_x = 0, offset_y = 0;  ///< optical axis from the centre of distortion; OpenPTV has one, OpenCV 0
  bool operator==(const CameraIntrinsics&) const = default;
};

/// x_camera = rotation·x_rig + translation; the camera looks along its z, x along columns, y along rows (down).
struct CameraPose {
  Matrix3 rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Point3 translation_mm{};
  bool operator==(const CameraPose&) const = default;
};

/// A calibrated camera. Immutable; all members are noexcept and free of allocation, for any thread.
class CameraModel {
 public:
  /// Throws Error(configuration) for what no camera can be: sizes or focal lengths that are not positive, a rotation
  /// that is none (1e-6), numbers that are not finite, interfaces as RefractedPath refuses them. `origin` (file,
  /// camera) stands before the message.
  explicit CameraModel(const CameraIntrinsics& intrinsics, const CameraPose& pose = {},
                       const RefractiveStack& stack = {}, const std::string& origin = "camera");

  /// Where the camera sees a point of the rig's frame (mm), also outside of the image. None behind the camera, beyond
  /// the fold of the distortion, or when no light comes through the interfaces.
  std::optional<Pixel> project(const Point3& point_mm) const noexcept;
  /// The same with the derivative, by implicit differentiation of Snell's law.
  std::optional<Pixel> project(const Point3& point_mm, PixelJacobian& jacobian) const noexcept;

  /// The inverse of project(), as far as it can be: points at origin + t·direction, t >= 0, are seen at `pixel`.
  SightRay ray(const Pixel& pixel) const noexcept;

  /// Whether the pixel's centre is on the sensor: -0.5 <= column < width - 0.5, and rows alike.
  bool in_image(const Pixel& pixel) const noexcept;

  const CameraIntrinsics& intrinsics() const noexcept { return intrinsics_; }
  const CameraPose& pose() const noexcept { return pose_; }
  const RefractiveStack& stack() const noexcept { return stack_; }
  /// Centre of projection in the rig's frame.
  const Point3& centre_mm() const noexcept { return path_.centre_mm(); }

 private:
  Pixel to_pixel(const Pixel& distorted) const noexcept;

  CameraIntrinsics intrinsics_;
  CameraPose pose_;
  RefractiveStack stack_;
  BrownDistortion distortion_;
  Matrix3 to_rig_;  ///< inverse of the rotation, also when that is rounded
  RefractedPath path_;
};

}  // namespace rptv
