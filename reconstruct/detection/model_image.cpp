// SPDX-License-Identifier: MIT
// Gaussians added to an image and taken away, each within the pixels where it can be seen.
#include "reconstruct/detection/model_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rptv {

ModelImage::ModelImage(const ImageShape& shape)
    : width_(static_cast<std::int32_t>(shape.width_px)),
      height_(static_cast<std::int32_t>(shape.height_px)),
      light_(shape.pixels()) {}

ModelImage::Box ModelImage::box(std::int32_t x, std::int32_t y, std::int32_t reach) const noexcept {
  return {std::max(x - reach, 0), std::min(x + reach, width_ - 1), std::max(y - reach, 0),
          std::min(y + reach, height_ - 1)};
}

std::int32_t ModelImage::reach(const FittedSpot& spot) noexcept {
  constexpr float kSeen = 0.1F;  // grey
  if (spot.peak <= kSeen) return 0;
  const float reach = std::ceil(std::sqrt(std::log(kSeen / spot.peak) / spot.bend));
  return static_cast<std::int32_t>(std::min(reach, static_cast<float>(kMostReach)));
}

void ModelImage::add(const FittedSpot& spot) noexcept {
  const std::int32_t seen = reach(spot);
  if (seen == 0) return;
  const Box b =
      box(static_cast<std::int32_t>(std::lround(spot.x_px)), static_cast<std::int32_t>(std::lround(spot.y_px)), seen);
  std::array<float, 2 * kMostReach + 1> along_x{};
  for (std::int32_t x = b.first_x; x <= b.last_x; ++x) {
    const auto off = static_cast<float>(x - spot.x_px);
    along_x[static_cast<std::size_t>(x - b.first_x)] = std::exp(spot.bend * off * off);
  }
  for (std::int32_t y = b.first_y; y <= b.last_y; ++y) {
    const auto off = static_cast<float>(y - spot.y_px);
    const float peak = spot.peak * std::exp(spot.bend * off * off);
    float* row = light_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    for (std::int32_t x = b.first_x; x <= b.last_x; ++x)
      row[x] += peak * along_x[static_cast<std::size_t>(x - b.first_x)];
  }
}

void ModelImage::clear(const FittedSpot& spot) noexcept {
  const Box b = box(spot.start.x, spot.start.y, kMostReach + static_cast<std::int32_t>(kMostMove) + 1);
  for (std::int32_t y = b.first_y; y <= b.last_y; ++y) {
    float* row = light_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    std::fill(row + b.first_x, row + b.last_x + 1, 0.0F);
  }
}

}  // namespace rptv
