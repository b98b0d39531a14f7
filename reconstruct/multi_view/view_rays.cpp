// SPDX-License-Identifier: MIT
// Traces the nodes of a view's table, interpolates between them, and fits a pinhole to the rays.
#include "reconstruct/multi_view/view_rays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/space_algebra.hpp"
#include "core/error.hpp"

namespace rptv {

namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr double kSteepest = 5;           // slope of a ray against the view's axis
constexpr double kTableError_px = 0.002;  // nodes are set closer until it is met
constexpr double kWidestStep_px = 32, kNarrowestStep_px = 4;

std::array<double, 2> depths_of(const Volume& volume, const Point3& axis) {
  const Point3 centre = volume.centre();
  double reach = 0;
  for (std::size_t k = 0; k < 3; ++k) reach += std::abs(axis[k]) * (volume.to[k] - centre[k]);
  return {-reach, reach};
}

}  // namespace

ViewRays::ViewRays(const CameraModel& model, const Volume& volume, const std::string& name)
    : centre_mm_(volume.centre()), width_px_(model.intrinsics().width_px), height_px_(model.intrinsics().height_px) {
  const auto seen = model.project(centre_mm_);
  const SightRay middle = seen ? model.ray(*seen) : SightRay{{}, {kNothing, kNothing, kNothing}};
  if (!middle.valid())
    throw Error(ExitCode::configuration,
                fmt::format("camera '{}' cannot see the volume's centre ({:.6g}, {:.6g}, {:.6g}) mm; correct "
                            "multi_view.volume_x_mm, volume_y_mm and volume_z_mm, or the rig file",
                            name, centre_mm_[0], centre_mm_[1], centre_mm_[2]));
  axes_[2] = middle.direction;
  const Point3& down = model.pose().rotation[1];
  const Point3 across = cross(down, axes_[2]);
  axes_[0] = (1 / norm(across)) * across;
  axes_[1] = cross(axes_[2], axes_[0]);
  depths_mm_ = depths_of(volume, axes_[2]);
  for (double step = kWidestStep_px; step >= kNarrowestStep_px; step /= 2) {
    fill(model, step);
    table_error_px_ = compare(model);
    if (table_error_px_ < kTableError_px) break;
  }
  fit_pinhole(name);
}

bool ViewRays::trace(const CameraModel& model, double column, double row, Node& node) const noexcept {
  node = {kNothing, kNothing, kNothing, kNothing};
  const SightRay ray = model.ray({column, row});
  if (!ray.valid()) return false;
  const Point3 along = axes_ * ray.direction, from = axes_ * (ray.origin_mm - centre_mm_);
  if (!(along[2] * kSteepest > 1)) return false;
  const double dx = along[0] / along[2], dy = along[1] / along[2];
  node = {from[0] - from[2] * dx, from[1] - from[2] * dy, dx, dy};
  return true;
}

// One cell beyond the image on each side, so that every pixel is between nodes.
void ViewRays::fill(const CameraModel& model, double step_px) {
  step_px_ = step_px;
  columns_ = static_cast<std::size_t>(std::ceil(width_px_ / step_px)) + 2;
  rows_ = static_cast<std::size_t>(std::ceil(height_px_ / step_px)) + 2;
  nodes_.resize(columns_ * rows_);
  for (std::size_t r = 0; r < rows_; ++r)
    for (std::size_t c = 0; c < columns_; ++c)
      trace(model, (static_cast<double>(c) - 0.5) * step_px, (static_cast<double>(r) - 0.5) * step_px,
            nodes_[r * columns_ + c]);
}

double ViewRays::compare(const CameraModel& model) const {
  double worst = 0;
  for (double row = 0; row < height_px_; row += 1.5 * step_px_)
    for (double column = 0; column < width_px_; column += 1.5 * step_px_) {
      Node exact;
      SeenRay ray;
      if (!trace(model, column, row, exact) || !look(column, row, ray)) continue;
      const double px_per_mm = 1 / std::sqrt(std::abs(ray.foot[0] * ray.foot[3] - ray.foot[1] * ray.foot[2]));
      for (const double t : depths_mm_)
        worst = std::max(worst, px_per_mm * std::hypot(ray.x + t * ray.dx - exact.x - t * exact.dx,
                                                       ray.y + t * ray.dy - exact.y - t * exact.dy));
    }
  return worst;
}

bool ViewRays::look(double column, double row, SeenRay& ray) const noexcept {
  if (!(column >= -0.5 && column < width_px_ - 0.5 && row >= -0.5 && row < height_px_ - 0.5)) return false;
  const double c = column / step_px_ + 0.5, r = row / step_px_ + 0.5;
  const auto left = static_cast<std::size_t>(c), top = static_cast<std::size_t>(r);
  const double f = c - static_cast<double>(left), g = r - static_cast<double>(top), per_px = 1 / step_px_;
  const Node* upper = &nodes_[top * columns_ + left];
  const Node* lower = upper + columns_;
  const auto mix = [&](double Node::*part, double& value, double& by_column, double& by_row) {
    const double a = upper[0].*part, b = upper[1].*part, d = lower[0].*part, e = lower[1].*part;
    const double above = a + f * (b - a), below = d + f * (e - d);
    value = above + g * (below - above);
    by_row = (below - above) * per_px;
    by_column = (b - a + g * (e - d - b + a)) * per_px;
  };
  mix(&Node::x, ray.x, ray.foot[0], ray.foot[1]);
  mix(&Node::y, ray.y, ray.foot[2], ray.foot[3]);
  mix(&Node::dx, ray.dx, ray.foot_dt[0], ray.foot_dt[1]);
  mix(&Node::dy, ray.dy, ray.foot_dt[2], ray.foot_dt[3]);
  return ray.x == ray.x;  // a cell with a node that sees nothing is not a number
}

// The point (foot_x, foot_y, centre_t) that the rays are nearest to: x = foot_x - centre_t·dx and y = foot_y -
// centre_t·dy, least squares over the nodes. centre_t, the depth of the pinhole, is negative.
void ViewRays::fit_pinhole(const std::string& name) {
  double n = 0, sum_x = 0, sum_y = 0, sum_dx = 0, sum_dy = 0, mixed = 0, square = 0;
  for (const Node& node : nodes_) {
    if (node.x != node.x) continue;
    n += 1, sum_x += node.x, sum_y += node.y, sum_dx += node.dx, sum_dy += node.dy;
    mixed += node.x * node.dx + node.y * node.dy, square += node.dx * node.dx + node.dy * node.dy;
  }
  SeenRay middle;
  if (n < 4 || !look((width_px_ - 1) / 2, (height_px_ - 1) / 2, middle))
    throw Error(ExitCode::configuration,
                fmt::format("camera '{}' gets no light at the middle of its image; correct the rig file", name));
  mixed -= (sum_x * sum_dx + sum_y * sum_dy) / n, square -= (sum_dx * sum_dx + sum_dy * sum_dy) / n;
  const double centre_t = -std::min(mixed / std::max(square, 1e-12), 1e7);
  foot_x_mm_ = (sum_x + centre_t * sum_dx) / n, foot_y_mm_ = (sum_y + centre_t * sum_dy) / n;
  scale_ = 1 / std::sqrt(std::abs(middle.foot[0] * middle.foot[3] - middle.foot[1] * middle.foot[2]));
  const double focal = -scale_ * centre_t;
  for (std::size_t k = 0; k < 3; ++k)
    pinhole_[0][k] = focal * axes_[0][k], pinhole_[1][k] = focal * axes_[1][k], pinhole_[2][k] = axes_[2][k];
  pinhole_[0][3] = -focal * foot_x_mm_, pinhole_[1][3] = -focal * foot_y_mm_, pinhole_[2][3] = -centre_t;
  pinhole_centre_mm_ = foot_x_mm_ * axes_[0] + foot_y_mm_ * axes_[1] + centre_t * axes_[2];
  range_ = {1e300, 1e300, -1e300, -1e300};
  for (const Node& node : nodes_) {
    if (node.x != node.x) continue;
    const double u = scale_ * (node.x - foot_x_mm_), v = scale_ * (node.y - foot_y_mm_);
    range_ = {std::min(range_[0], u), std::min(range_[1], v), std::max(range_[2], u), std::max(range_[3], v)};
    for (const double t : depths_mm_) {
      const double per_depth = focal / (t - centre_t);
      wander_px_ = std::max(wander_px_, std::hypot(per_depth * (node.x + t * node.dx - foot_x_mm_) - u,
                                                   per_depth * (node.y + t * node.dy - foot_y_mm_) - v));
    }
  }
}

}  // namespace rptv
