// SPDX-License-Identifier: MIT
// Looks up the rays of a frame's detections and indexes them.
#include "reconstruct/seen_view.hpp"

#include <algorithm>
#include <limits>

#include "calibration/space_algebra.hpp"

namespace rptv {

std::array<double, 2> miss_px(const SeenRay& ray, const Matrix3& axes, const Point3& at_mm) noexcept {
  const double t = dot(axes[2], at_mm);
  const double off_x = dot(axes[0], at_mm) - ray.x - t * ray.dx, off_y = dot(axes[1], at_mm) - ray.y - t * ray.dy;
  const double a = ray.foot[0] + t * ray.foot_dt[0], b = ray.foot[1] + t * ray.foot_dt[1];
  const double c = ray.foot[2] + t * ray.foot_dt[2], d = ray.foot[3] + t * ray.foot_dt[3];
  const double per = 1 / (a * d - b * c);
  return {per * (d * off_x - b * off_y), per * (a * off_y - c * off_x)};
}

SeenView::SeenView(const ViewRays& rays, std::size_t capacity, double scale_mm)
    : rays_(&rays), scale_mm_(scale_mm), ray_(capacity), row_pair_(capacity), u_(capacity), v_(capacity) {
  const auto& range = rays.pinhole_range();
  across_u_ = StripIndex(capacity, range);
  across_v_ = StripIndex(capacity, {range[1], range[0], range[3], range[2]});
}

std::size_t SeenView::look(const Detections& seen) noexcept {
  size_ = std::min(seen.size(), ray_.size());
  std::size_t lost = seen.size() - size_;
  const Matrix3& axes = rays_->axes();
  for (std::size_t i = 0; i < size_; ++i) {
    SeenRay& ray = ray_[i];
    if (!rays_->look(seen.x_px[i], seen.y_px[i], ray)) {
      u_[i] = v_[i] = std::numeric_limits<double>::quiet_NaN();
      ++lost;
      continue;
    }
    const auto image = rays_->in_pinhole(ray);
    u_[i] = image[0], v_[i] = image[1];
    const double per = 1 / (ray.foot[0] * ray.foot[3] - ray.foot[1] * ray.foot[2]);
    const double a = per * ray.foot[3], b = -per * ray.foot[1], c = -per * ray.foot[2], d = per * ray.foot[0];
    const double skew_column = a * ray.dx + b * ray.dy, skew_row = c * ray.dx + d * ray.dy;
    auto& [column, row] = row_pair_[i];
    for (std::size_t k = 0; k < 3; ++k) {
      column[k] = scale_mm_ * (a * axes[0][k] + b * axes[1][k] - skew_column * axes[2][k]);
      row[k] = scale_mm_ * (c * axes[0][k] + d * axes[1][k] - skew_row * axes[2][k]);
    }
    column[3] = -a * ray.x - b * ray.y, row[3] = -c * ray.x - d * ray.y;
  }
  across_u_.build(u_.data(), v_.data(), size_);
  across_v_.build(v_.data(), u_.data(), size_);
  return lost;
}

void SeenView::sight(std::size_t i, Point3& from_mm, Point3& along) const noexcept {
  const Matrix3& axes = rays_->axes();
  const SeenRay& ray = ray_[i];
  from_mm = ray.x * axes[0] + ray.y * axes[1];
  along = ray.dx * axes[0] + ray.dy * axes[1] + axes[2];
}

}  // namespace rptv
