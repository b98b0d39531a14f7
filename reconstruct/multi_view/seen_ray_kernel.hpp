// SPDX-License-Identifier: MIT
// One pixel's ray in its view's frame, and by how many pixels it misses a point.
#pragma once

#include <array>

#include "calibration/space_algebra.hpp"
#include "reconstruct/host_device.hpp"

namespace rptv {

/// In the view's frame, whose origin is the volume's centre: at depth t (mm, away from the camera) the ray is at
/// (x + t·dx, y + t·dy), and moves by foot + t·foot_dt (2×2 by rows, mm/px) when column and row do.
struct SeenRay {
  double x, y, dx, dy;
  std::array<double, 4> foot, foot_dt;
};

/// A central projection of points relative to the volume's centre: (p[0]·(Y, 1), p[1]·(Y, 1)) / p[2]·(Y, 1), px.
using Projection = std::array<std::array<double, 4>, 3>;

/// The part of a ray that is in the volume, relative to the volume's centre: from + t·along, near <= t <= far, mm.
struct Sight {
  Point3 from_mm, along;
  double near = 0, far = 0;
};

/// Point and direction per mm of depth of a ray, in the rig's axes, relative to the volume's centre; `axes` are those
/// of its view. The depths are left alone.
RPTV_HOST_DEVICE inline void sight_along(const SeenRay& ray, const Matrix3& axes, Point3& from_mm,
                                         Point3& along) noexcept {
  from_mm = ray.x * axes[0] + ray.y * axes[1];
  along = ray.dx * axes[0] + ray.dy * axes[1] + axes[2];
}

/// Column and row by which a ray misses a point (relative to the volume's centre), px: the reprojection error, to first
/// order in itself.
RPTV_HOST_DEVICE inline std::array<double, 2> miss_px(const SeenRay& ray, const Matrix3& axes,
                                                      const Point3& at_mm) noexcept {
  const double t = dot(axes[2], at_mm);
  const double off_x = dot(axes[0], at_mm) - ray.x - t * ray.dx, off_y = dot(axes[1], at_mm) - ray.y - t * ray.dy;
  const double a = ray.foot[0] + t * ray.foot_dt[0], b = ray.foot[1] + t * ray.foot_dt[1];
  const double c = ray.foot[2] + t * ray.foot_dt[2], d = ray.foot[3] + t * ray.foot_dt[3];
  const double per = 1 / (a * d - b * c);
  return {per * (d * off_x - b * off_y), per * (a * off_y - c * off_x)};
}

}  // namespace rptv
