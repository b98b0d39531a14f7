// SPDX-License-Identifier: MIT
// Where on each sensor the target was seen, and how well it fits there.
#include <algorithm>
#include <cmath>

#include "calibration/cameras/cameras_report.hpp"

namespace rptv {

namespace {

constexpr int kPanelWidth_px = 480, kGap_px = 8;
constexpr int kDot_px = 2;  // half width
constexpr Colour kGround{24, 24, 28}, kBetween{255, 255, 255};

/// Blue over grey to red, for errors from 0 to five standard errors.
Colour colour_of(double error_sigmas) {
  const double a = std::clamp(error_sigmas / 5, 0.0, 1.0);
  const auto mix = [&](double from, double middle, double to) {
    const double value = a < 0.5 ? from + (middle - from) * 2 * a : middle + (to - middle) * (2 * a - 1);
    return static_cast<std::uint8_t>(std::lround(value));
  };
  return {mix(80, 210, 255), mix(160, 210, 60), mix(255, 210, 50)};
}

struct Panel {
  int left = 0, top = 0, width = 0, height = 0;
  double scale = 1;  // panel's pixels per pixel
};

std::vector<Panel> panels_of(const std::vector<CameraImages>& cameras) {
  const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(cameras.size()))));
  std::vector<Panel> panels;
  int top = kGap_px, tallest = 0;
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    const int column = static_cast<int>(k) % columns;
    if (column == 0 && k > 0) top += tallest + kGap_px, tallest = 0;
    const double scale = static_cast<double>(kPanelWidth_px) / cameras[k].width_px;
    const int height = std::max(1, static_cast<int>(std::lround(scale * cameras[k].height_px)));
    panels.push_back({kGap_px + column * (kPanelWidth_px + kGap_px), top, kPanelWidth_px, height, scale});
    tallest = std::max(tallest, height);
  }
  return panels;
}

}  // namespace

ColourImage draw_coverage(const CameraCalibration& c) {
  const auto panels = panels_of(c.used.cameras);
  int width = 0, height = 0;
  for (const auto& p : panels) {
    width = std::max(width, p.left + p.width + kGap_px);
    height = std::max(height, p.top + p.height + kGap_px);
  }
  ColourImage picture(width, height, kBetween);
  for (const auto& p : panels)
    for (int row = 0; row < p.height; ++row)
      for (int column = 0; column < p.width; ++column) picture.set(p.left + column, p.top + row, kGround);
  auto residuals = c.result.residuals;
  const auto error = [](const PointResidual& r) { return std::hypot(r.error_px[0], r.error_px[1]); };
  std::sort(residuals.begin(), residuals.end(),  // the worst on top
            [&](const PointResidual& a, const PointResidual& b) { return error(a) < error(b); });
  for (const auto& r : residuals) {
    const Panel& p = panels[c.used.images[r.image].camera];
    const int x = static_cast<int>(std::lround(p.scale * r.seen.pixel[0])),
              y = static_cast<int>(std::lround(p.scale * r.seen.pixel[1]));
    for (int row = std::max(0, y - kDot_px); row <= std::min(p.height - 1, y + kDot_px); ++row)
      for (int column = std::max(0, x - kDot_px); column <= std::min(p.width - 1, x + kDot_px); ++column)
        picture.set(p.left + column, p.top + row, colour_of(error(r) / c.result.sigma_px));
  }
  return picture;
}

}  // namespace rptv
