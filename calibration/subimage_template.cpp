// SPDX-License-Identifier: MIT
// Folding an image into one cell, and registering each cell against the fold.
#include "calibration/subimage_template.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace rptv {

namespace {
constexpr double kGuardPx = 3;  // the template reaches further than the window, so that it can be shifted
}

SubimageTemplate::SubimageTemplate(const GreyImage& image, std::span<const std::array<double, 2>> centres_px,
                                   double window_px)
    : window_px_(window_px),
      half_(static_cast<int>(std::ceil((window_px + kGuardPx) * kFiner))),
      side_(2 * half_ + 1),
      grid_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_)) {
  std::vector<double> count(grid_.size());
  const int reach = static_cast<int>(std::ceil(window_px + kGuardPx));
  for (const auto& [x, y] : centres_px) {
    const int i0 = static_cast<int>(std::lround(x)), j0 = static_cast<int>(std::lround(y));
    for (int j = std::max(0, j0 - reach); j <= std::min(image.height - 1, j0 + reach); ++j)
      for (int i = std::max(0, i0 - reach); i <= std::min(image.width - 1, i0 + reach); ++i) {
        const auto a = static_cast<int>(std::lround((i - x) * kFiner)),
                   b = static_cast<int>(std::lround((j - y) * kFiner));
        if (std::abs(a) > half_ || std::abs(b) > half_) continue;
        for (const int sign : {1, -1}) {  // half a turn
          const auto at = static_cast<std::size_t>((half_ + sign * b) * side_ + half_ + sign * a);
          grid_[at] += image.at(i, j), ++count[at];
        }
      }
  }
  double total = 0, samples = 0;
  for (std::size_t k = 0; k < grid_.size(); ++k) total += grid_[k], samples += count[k];
  for (std::size_t k = 0; k < grid_.size(); ++k) grid_[k] = count[k] > 0 ? grid_[k] / count[k] : total / samples;
  smooth();
  lowest_ = 1e300, highest_ = -1e300;
  for (int j = -half_; j <= half_; ++j)
    for (int i = -half_; i <= half_; ++i) {
      if (std::hypot(i, j) > window_px_ * kFiner) continue;
      lowest_ = std::min(lowest_, cell(half_ + i, half_ + j)),
      highest_ = std::max(highest_, cell(half_ + i, half_ + j));
    }
}

void SubimageTemplate::smooth() {  // binomial, 1 2 1 in both directions: half a pixel across
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<double> smoothed = grid_;
    for (int j = 0; j < side_; ++j)
      for (int i = 0; i < side_; ++i) {
        const auto value = [&](int k) {
          return pass == 0 ? cell(std::clamp(i + k, 0, side_ - 1), j) : cell(i, std::clamp(j + k, 0, side_ - 1));
        };
        smoothed[static_cast<std::size_t>(j * side_ + i)] = 0.25 * value(-1) + 0.5 * value(0) + 0.25 * value(1);
      }
    grid_ = std::move(smoothed);
  }
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
