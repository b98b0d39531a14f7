// SPDX-License-Identifier: MIT
// Looks up the rays of a frame's detections and indexes them.
#include "reconstruct/multi_view/seen_view.hpp"

#include <algorithm>
#include <limits>

namespace rptv {

SeenView::SeenView(const ViewRays& rays, std::size_t capacity, double scale_mm, bool both)
    : rays_(&rays), scale_mm_(scale_mm), both_(both), ray_(capacity), row_pair_(capacity), u_(capacity), v_(capacity) {
  const auto& range = rays.pinhole_range();
  across_u_ = StripIndex(capacity, range);
  if (both) across_v_ = StripIndex(capacity, {range[1], range[0], range[3], range[2]});
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
  if (both_) across_v_.build(v_.data(), u_.data(), size_);
  return lost;
}

void SeenView::sight(std::size_t i, Point3& from_mm, Point3& along) const noexcept {
  sight_along(ray_[i], rays_->axes(), from_mm, along);
}

}  // namespace rptv
