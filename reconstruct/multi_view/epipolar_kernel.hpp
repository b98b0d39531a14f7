// SPDX-License-Identifier: MIT
// A ray of one view as another view sees it: its epipolar line, and where on it a given depth is.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "reconstruct/multi_view/seen_ray_kernel.hpp"

namespace rptv {

/// False when the ray misses the box of half-edges `half_mm` round the origin.
RPTV_HOST_DEVICE inline bool clip(const Point3& half_mm, Sight& sight) noexcept {
  sight.near = -1e9, sight.far = 1e9;
  for (std::size_t k = 0; k < 3; ++k) {
    const double per = 1 / sight.along[k];  // infinite where the ray is parallel: then one of the bounds decides
    const double a = (-half_mm[k] - sight.from_mm[k]) * per, b = (half_mm[k] - sight.from_mm[k]) * per;
    sight.near = std::max(sight.near, std::min(a, b));
    sight.far = std::min(sight.far, std::max(a, b));
  }
  return sight.near < sight.far;
}

/// Depth on `sight` where it is nearest to the line from + r·along.
RPTV_HOST_DEVICE inline double nearest_depth(const Sight& sight, const Point3& from, const Point3& along) noexcept {
  const Point3 apart = sight.from_mm - from;
  const double mixed = dot(sight.along, along), square = dot(along, along);
  return (mixed * dot(along, apart) - square * dot(sight.along, apart)) /
         (dot(sight.along, sight.along) * square - mixed * mixed);
}

/// A sight in another view's pinhole image: (p + t·q)[0, 1] / (p + t·q)[2], a straight line. With refraction the true
/// image is up to ViewRays::wander_px() away from it.
struct EpipolarLine {
  Point3 p{}, q{};

  EpipolarLine() = default;
  RPTV_HOST_DEVICE EpipolarLine(const Projection& pinhole, const Sight& sight) noexcept {
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t k = 0; k < 3; ++k) {
        p[r] += pinhole[r][k] * sight.from_mm[k] + (k == 2 ? pinhole[r][3] : 0);
        q[r] += pinhole[r][k] * sight.along[k];
      }
  }
  RPTV_HOST_DEVICE std::array<double, 2> at(double t) const noexcept {
    const double per = 1 / (p[2] + t * q[2]);
    return {per * (p[0] + t * q[0]), per * (p[1] + t * q[1])};
  }
  /// In front of the pinhole all along.
  RPTV_HOST_DEVICE bool in_front(const Sight& sight) const noexcept {
    return p[2] + sight.near * q[2] > 0 && p[2] + sight.far * q[2] > 0;
  }
  /// The depth whose image has coordinate `value` on axis 0 (u) or 1 (v).
  RPTV_HOST_DEVICE double depth(std::size_t axis, double value) const noexcept {
    return (value * p[2] - p[axis]) / (q[axis] - value * q[2]);
  }
  /// Where depth t is, and how that moves with t, px per mm.
  struct Place {
    double u, v, du, dv;
  };
  RPTV_HOST_DEVICE Place place(double t) const noexcept {
    const double per = 1 / (p[2] + t * q[2]), u = per * (p[0] + t * q[0]), v = per * (p[1] + t * q[1]);
    return {u, v, per * (q[0] - u * q[2]), per * (q[1] - v * q[2])};
  }
};

}  // namespace rptv
