// SPDX-License-Identifier: MIT
// Every pixel has the light of the lenslet that it belongs to.
#include "reconstruct/light_field/calibrated_pixels.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rptv {

namespace {

constexpr std::size_t kReach = 8;

// Sums of squares over boxes, from sums over all that lies left of and above a pixel.
void raise_to_neighbours(std::vector<float>& noise, std::size_t width) {
  const std::size_t height = noise.size() / width, stride = width + 1;
  std::vector<double> above(stride * (height + 1));
  for (std::size_t row = 0; row < height; ++row) {
    double sum = 0;
    for (std::size_t column = 0; column < width; ++column) {
      const auto value = static_cast<double>(noise[row * width + column]);
      sum += value * value;
      above[(row + 1) * stride + column + 1] = above[row * stride + column + 1] + sum;
    }
  }
  for (std::size_t row = 0; row < height; ++row)
    for (std::size_t column = 0; column < width; ++column) {
      const std::size_t left = column - std::min(column, kReach), right = std::min(column + kReach + 1, width);
      const std::size_t top = row - std::min(row, kReach), bottom = std::min(row + kReach + 1, height);
      const double squares = above[bottom * stride + right] - above[bottom * stride + left] -
                             above[top * stride + right] + above[top * stride + left];
      const auto rms = std::sqrt(std::max(squares, 0.0) / static_cast<double>((right - left) * (bottom - top)));
      float& own = noise[row * width + column];
      own = std::max(own, static_cast<float>(rms));
    }
}

}  // namespace

CalibratedPixels calibrated_pixels(const LightFieldCalibration& calibration, const LensletLattice& lattice,
                                   double least_share) {
  CalibratedPixels pixels;
  pixels.level = calibration.arrays.dark_level, pixels.noise = calibration.arrays.dark_noise;
  if (!pixels.noise.empty()) raise_to_neighbours(pixels.noise, calibration.arrays.width_px);
  if (calibration.arrays.vignetting.empty()) return pixels;
  const auto [axis_x, axis_y] = calibration.optical_axis_px();
  const auto width = calibration.sensor.width_px, height = calibration.sensor.height_px;
  const auto least = static_cast<float>(std::min(least_share, 1.0));
  pixels.share.reserve(static_cast<std::size_t>(width * height));
  for (std::int64_t row = 0; row < height; ++row)
    for (std::int64_t column = 0; column < width; ++column) {
      std::array<std::uint32_t, 1> lenslet{};
      lattice.lenslets_of((static_cast<double>(column) - axis_x) * calibration.pixel_mm(),
                          (static_cast<double>(row) - axis_y) * calibration.pixel_mm(), lenslet);
      const float light = lenslet[0] == LensletLattice::kNone ? 0 : lattice.brightness(lenslet[0]);
      pixels.share.push_back(light > 0 ? std::clamp(light, least, 1.0F) : 1.0F);
    }
  return pixels;
}

}  // namespace rptv
