// SPDX-License-Identifier: MIT
// What one view saw in one frame, made ready for matching: rays, rows of the DLT, and an index of the pinhole image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calibration/space_algebra.hpp"
#include "reconstruct/detection/detections.hpp"
#include "reconstruct/multi_view/dlt.hpp"
#include "reconstruct/multi_view/strip_index.hpp"
#include "reconstruct/multi_view/view_rays.hpp"

namespace rptv {

/// Column and row by which a ray misses a point (relative to the volume's centre), px: the reprojection error, to first
/// order in itself.
inline std::array<double, 2> miss_px(const SeenRay& ray, const Matrix3& axes, const Point3& at_mm) noexcept {
  const double t = dot(axes[2], at_mm);
  const double off_x = dot(axes[0], at_mm) - ray.x - t * ray.dx, off_y = dot(axes[1], at_mm) - ray.y - t * ray.dy;
  const double a = ray.foot[0] + t * ray.foot_dt[0], b = ray.foot[1] + t * ray.foot_dt[1];
  const double c = ray.foot[2] + t * ray.foot_dt[2], d = ray.foot[3] + t * ray.foot_dt[3];
  const double per = 1 / (a * d - b * c);
  return {per * (d * off_x - b * off_y), per * (a * off_y - c * off_x)};
}

/// Memory is taken at construction. One thread at a time.
class SeenView {
 public:
  /// `scale_mm` divides coordinates in rows(). `both`: across_v() is needed, too.
  SeenView(const ViewRays& rays, std::size_t capacity, double scale_mm, bool both = true);

  /// Takes a frame's detections; returns how many no light from the volume can have made, or for which is no room.
  std::size_t look(const Detections& seen) noexcept;

  const ViewRays& rays() const noexcept { return *rays_; }
  std::size_t size() const noexcept { return size_; }
  /// False for a detection that look() counted.
  bool usable(std::size_t i) const noexcept { return u_[i] == u_[i]; }
  /// Where its ray is in the pinhole image, px.
  double u(std::size_t i) const noexcept { return u_[i]; }
  double v(std::size_t i) const noexcept { return v_[i]; }
  const SeenRay& ray(std::size_t i) const noexcept { return ray_[i]; }
  /// Misses in px of the ray at depth 0, as rows of eq. (4) for (x, y, z) / scale_mm.
  const DltRowPair& rows(std::size_t i) const noexcept { return row_pair_[i]; }
  /// A point of the ray, and its direction per mm of depth, in the rig's axes, relative to the volume's centre.
  void sight(std::size_t i, Point3& from_mm, Point3& along) const noexcept;

  /// Points of the pinhole image: of strips that lie across u, and of strips that lie across v.
  const StripIndex& across_u() const noexcept { return across_u_; }
  const StripIndex& across_v() const noexcept { return across_v_; }

 private:
  const ViewRays* rays_;
  double scale_mm_;
  bool both_;
  std::size_t size_ = 0;
  std::vector<SeenRay> ray_;
  std::vector<DltRowPair> row_pair_;
  std::vector<double> u_, v_;
  StripIndex across_u_, across_v_;
};

}  // namespace rptv
