// SPDX-License-Identifier: MIT
// Crosses and arrows, pixel by pixel.
#include "calibration/light_field/calibration_figures.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace rptv {

namespace {

constexpr Colour kWhite{255, 255, 255}, kBlack{0, 0, 0}, kGreen{0, 220, 60}, kOrange{255, 150, 0}, kRed{255, 40, 40},
    kBlue{90, 130, 230};

Colour colour_of(std::uint8_t reason, Colour fitted) {
  if (reason == 0) return fitted;
  return (reason & (lenslet_reason::kBrightness | lenslet_reason::kResidual)) != 0 ? kRed : kOrange;
}

void draw_line(ColourImage& picture, double x0, double y0, double x1, double y1, Colour colour, int thickness) {
  const int steps = static_cast<int>(std::ceil(std::max(std::abs(x1 - x0), std::abs(y1 - y0)))) + 1;
  for (int k = 0; k <= std::min(steps, 10000); ++k) {
    const double a = static_cast<double>(k) / steps;
    const int x = static_cast<int>(std::lround(x0 + a * (x1 - x0))),
              y = static_cast<int>(std::lround(y0 + a * (y1 - y0)));
    for (int dy = 0; dy < thickness; ++dy)
      for (int dx = 0; dx < thickness; ++dx) picture.set(x + dx, y + dy, colour);
  }
}

void draw_arrow(ColourImage& picture, double x, double y, double dx, double dy, Colour colour, int thickness) {
  draw_line(picture, x, y, x + dx, y + dy, colour, thickness);
  for (const double side : {1.0, -1.0})  // two barbs, a third as long, half a right angle back
    draw_line(picture, x + dx, y + dy, x + dx - 0.24 * (dx + side * dy), y + dy - 0.24 * (dy - side * dx), colour,
              thickness);
}

}  // namespace

ColourImage draw_centres(const GreyImage& image, const FoundLenslets& found) {
  std::vector<float> sorted = image.grey;
  const auto top = sorted.begin() + static_cast<std::ptrdiff_t>(0.998 * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), top, sorted.end());
  ColourImage picture(image.width, image.height, kBlack);
  for (std::size_t i = 0; i < image.grey.size(); ++i) {
    const double level = std::clamp(image.grey[i] / std::max(*top, 1e-6F), 0.0F, 1.0F);
    const auto grey = static_cast<std::uint8_t>(std::lround(235 * std::sqrt(level)));
    picture.pixels[i] = {grey, grey, grey};
  }
  for (const auto& s : found.spots) {
    const Colour colour = colour_of(s.reason, kGreen);
    draw_line(picture, s.predicted_x_px - 2, s.predicted_y_px, s.predicted_x_px + 2, s.predicted_y_px, colour, 1);
    draw_line(picture, s.predicted_x_px, s.predicted_y_px - 2, s.predicted_x_px, s.predicted_y_px + 2, colour, 1);
  }
  return picture;
}

ColourImage draw_residuals(const GreyImage& image, const FoundLenslets& found, double enlargement) {
  ColourImage picture(image.width, image.height, kWhite);
  struct Block {
    double x = 0, y = 0, dx = 0, dy = 0, count = 0;
  };
  std::map<std::pair<int, int>, Block> blocks;
  constexpr int kBlock = 8, kLeast = 16;
  for (const auto& s : found.spots) {
    if (!s.matched) continue;
    const double dx = s.x_px - s.predicted_x_px, dy = s.y_px - s.predicted_y_px;
    draw_arrow(picture, s.predicted_x_px, s.predicted_y_px, enlargement * dx, enlargement * dy,
               colour_of(s.reason, kBlue), 1);
    if (s.reason != 0) continue;
    const auto index = [](int k) { return static_cast<int>(std::floor(static_cast<double>(k) / kBlock)); };
    Block& block = blocks[{index(s.u), index(s.v)}];
    block.x += s.predicted_x_px, block.y += s.predicted_y_px, block.dx += dx, block.dy += dy, ++block.count;
  }
  for (const auto& [index, b] : blocks)
    if (b.count >= kLeast)
      draw_arrow(picture, b.x / b.count, b.y / b.count, enlargement * b.dx / b.count, enlargement * b.dy / b.count,
                 kBlack, 3);
  return picture;
}

double residual_enlargement(const FoundLenslets& found, double pitch_px) {
  std::vector<double> sizes;
  for (const auto& s : found.spots)
    if (s.reason == 0) sizes.push_back(std::hypot(s.x_px - s.predicted_x_px, s.y_px - s.predicted_y_px));
  if (sizes.empty()) return 1;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  const double wanted = pitch_px / 3 / std::max(*middle, 1e-4), power = std::pow(10, std::floor(std::log10(wanted)));
  for (const double step : {5.0, 2.0})
    if (wanted >= step * power) return step * power;
  return power;
}

}  // namespace rptv
