// SPDX-License-Identifier: MIT
// Folding an image into one cell, and registering each cell against the fold.
#include "calibration/light_field/subimage_template.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace rptv {

namespace {
constexpr double kGuardPx = 3;     // the template reaches further than the window, so that it can be shifted
constexpr double kReachNodes = 2;  // of the weight round a node: two thirds of a pixel
}  // namespace

/// A plane through the pixels round one node, by weighted least squares, and its height there. A mean would be biased
/// where the lattice puts more pixels on one side of the node than on the other, as lattices nearly commensurate with
/// the pixels do.
struct LocalPlane {
  double w = 0, wx = 0, wy = 0, wxx = 0, wxy = 0, wyy = 0, v = 0, vx = 0, vy = 0;

  void add(double x, double y, double value) noexcept {
    const double weight = (1 - std::abs(x) / kReachNodes) * (1 - std::abs(y) / kReachNodes);
    w += weight, wx += weight * x, wy += weight * y;
    wxx += weight * x * x, wxy += weight * x * y, wyy += weight * y * y;
    v += weight * value, vx += weight * x * value, vy += weight * y * value;
  }

  /// What another plane's pixels would add after half a turn round its node.
  void add_turned(const LocalPlane& other) noexcept {
    w += other.w, wx -= other.wx, wy -= other.wy, wxx += other.wxx, wxy += other.wxy, wyy += other.wyy;
    v += other.v, vx -= other.vx, vy -= other.vy;
  }

  double value_or(double otherwise) const noexcept {
    if (!(w > 0)) return otherwise;
    const double mx = wx / w, my = wy / w;
    const double xx = wxx / w - mx * mx, xy = wxy / w - mx * my, yy = wyy / w - my * my;
    const double xv = vx / w - mx * v / w, yv = vy / w - my * v / w;
    const double determinant = xx * yy - xy * xy;
    constexpr double kLeastSpread = 1e-2;  // nodes to the fourth: fewer than three pixels, or in a line
    if (!(determinant > kLeastSpread)) return v / w;
    return v / w - (mx * (yy * xv - xy * yv) + my * (xx * yv - xy * xv)) / determinant;
  }
};

SubimageTemplate::SubimageTemplate(const GreyImage& image, std::span<const std::array<double, 2>> centres_px,
                                   double window_px)
    : window_px_(window_px),
      half_(static_cast<int>(std::ceil((window_px + kGuardPx) * kFiner))),
      side_(2 * half_ + 1),
      grid_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_)) {
  std::vector<LocalPlane> nodes(grid_.size());
  const int reach = static_cast<int>(std::ceil(window_px + kGuardPx));
  double total = 0, samples = 0;
  for (const auto& [x, y] : centres_px) {
    const int i0 = static_cast<int>(std::lround(x)), j0 = static_cast<int>(std::lround(y));
    for (int j = std::max(0, j0 - reach); j <= std::min(image.height - 1, j0 + reach); ++j)
      for (int i = std::max(0, i0 - reach); i <= std::min(image.width - 1, i0 + reach); ++i) {
        total += image.at(i, j), ++samples;
        spread(nodes, half_ + (i - x) * kFiner, half_ + (j - y) * kFiner, image.at(i, j));
      }
  }
  for (std::size_t k = 0; k < grid_.size(); ++k) {
    LocalPlane both = nodes[k];
    both.add_turned(nodes[grid_.size() - 1 - k]);
    grid_[k] = both.value_or(total / samples);
  }
  lowest_ = 1e300, highest_ = -1e300;
  for (int j = -half_; j <= half_; ++j)
    for (int i = -half_; i <= half_; ++i) {
      if (std::hypot(i, j) > window_px_ * kFiner) continue;
      lowest_ = std::min(lowest_, cell(half_ + i, half_ + j)),
      highest_ = std::max(highest_, cell(half_ + i, half_ + j));
    }
}

/// To the nodes within kReachNodes of (x, y), in nodes from the first.
void SubimageTemplate::spread(std::vector<LocalPlane>& nodes, double x, double y, double value) const {
  const int first_i = std::max(0, static_cast<int>(std::ceil(x - kReachNodes))),
            last_i = std::min(side_ - 1, static_cast<int>(std::floor(x + kReachNodes)));
  const int first_j = std::max(0, static_cast<int>(std::ceil(y - kReachNodes))),
            last_j = std::min(side_ - 1, static_cast<int>(std::floor(y + kReachNodes)));
  for (int j = first_j; j <= last_j; ++j)
    for (int i = first_i; i <= last_i; ++i) nodes[static_cast<std::size_t>(j * side_ + i)].add(x - i, y - j, value);
}

SubimageTemplate::Sample SubimageTemplate::sample(double dx_px, double dy_px) const noexcept {
  const double x = std::clamp(dx_px * kFiner + half_, 0.0, side_ - 1.001),
               y = std::clamp(dy_px * kFiner + half_, 0.0, side_ - 1.001);
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const double a = x - i, b = y - j;
  const double top = cell(i + 1, j) - cell(i, j), bottom = cell(i + 1, j + 1) - cell(i, j + 1);
  const double left = cell(i, j + 1) - cell(i, j), right = cell(i + 1, j + 1) - cell(i + 1, j);
  return {cell(i, j) + a * top + b * (left + a * (right - left)), kFiner * (top + b * (bottom - top)),
          kFiner * (left + a * (right - left))};
}

TemplateMatch SubimageTemplate::match(const GreyImage& image, std::array<double, 2> at_px) const {
  TemplateMatch match;
  const int reach = static_cast<int>(std::ceil(window_px_));
  const int i0 = static_cast<int>(std::lround(at_px[0])), j0 = static_cast<int>(std::lround(at_px[1]));
  constexpr int kSteps = 5;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for (int j = std::max(0, j0 - reach); j <= std::min(image.height - 1, j0 + reach); ++j)
      for (int i = std::max(0, i0 - reach); i <= std::min(image.width - 1, i0 + reach); ++i) {
        const double dx = i - at_px[0] - match.dx_px, dy = j - at_px[1] - match.dy_px;
        if (dx * dx + dy * dy > window_px_ * window_px_) continue;
        const Sample s = sample(dx, dy);
        const Eigen::Vector4d row(s.value, 1, -s.slope_x, -s.slope_y);
        normal.noalias() += row * row.transpose();
        right.noalias() += row * static_cast<double>(image.at(i, j));
      }
    const Eigen::Vector4d solution = normal.ldlt().solve(right);
    match.amplitude = solution[0], match.background = solution[1];
    if (!(match.amplitude > 0.02)) return match;
    const double dx = solution[2] / solution[0], dy = solution[3] / solution[0];
    const double damping = std::min(1.0, 1.5 / std::max(std::hypot(dx, dy), 1e-12));
    match.dx_px += damping * dx, match.dy_px += damping * dy;
    if (!(std::hypot(match.dx_px, match.dy_px) < 0.5 * window_px_)) return match;
    if (std::hypot(dx, dy) < 1e-3) break;
  }
  match.found = true;
  return match;
}

double SubimageTemplate::half_height_diameter_px() const noexcept {
  double area = 0;
  for (int j = -half_; j <= half_; ++j)
    for (int i = -half_; i <= half_; ++i)
      if (std::hypot(i, j) <= window_px_ * kFiner && cell(half_ + i, half_ + j) > 0.5 * (lowest_ + highest_)) ++area;
  return 2 * std::sqrt(area / std::numbers::pi) / kFiner;
}

}  // namespace rptv
