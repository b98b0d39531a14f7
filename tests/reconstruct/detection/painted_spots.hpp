// SPDX-License-Identifier: MIT
// Images of Gaussian spots with the noise of a camera.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "core/image.hpp"

namespace rptv::testing {

struct PaintedSpot {
  double x_px, y_px, sigma_px, peak;  ///< peak: grey value that its profile has in the middle, before pixels integrate
};

struct Camera {
  ImageShape shape{256, 256, 1};
  double background = 10, noise_grey = 2, electrons_per_grey = 4, highest = 255;
};

/// `count` spots, at least `apart_px` from each other and `margin_px` from the border.
inline std::vector<PaintedSpot> scatter_spots(const ImageShape& shape, std::size_t count, double apart_px,
                                              double margin_px, double sigma_px, double peak, std::mt19937& random) {
  std::uniform_real_distribution<double> x(margin_px, shape.width_px - 1 - margin_px);
  std::uniform_real_distribution<double> y(margin_px, shape.height_px - 1 - margin_px);
  std::vector<PaintedSpot> spots;
  for (std::size_t trial = 0; spots.size() < count && trial < 100 * count; ++trial) {
    const PaintedSpot spot{x(random), y(random), sigma_px, peak};
    if (apart_px == 0 || std::none_of(spots.begin(), spots.end(), [&](const PaintedSpot& other) {
          return std::hypot(other.x_px - spot.x_px, other.y_px - spot.y_px) < apart_px;
        }))
      spots.push_back(spot);
  }
  return spots;
}

class SpotImage {
 public:
  SpotImage(const Camera& camera, const std::vector<PaintedSpot>& spots, std::mt19937& random)
      : shape_(camera.shape), bytes_(camera.shape.bytes()) {
    std::vector<double> light(shape_.pixels());
    for (const auto& spot : spots) add(spot, light);
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < light.size(); ++i) {
      const double noise = std::sqrt(camera.noise_grey * camera.noise_grey + light[i] / camera.electrons_per_grey);
      const double grey = camera.background + light[i] + noise * normal(random);
      const auto value = static_cast<std::uint16_t>(std::lround(std::clamp(grey, 0.0, camera.highest)));
      if (shape_.bytes_per_pixel == 1)
        bytes_[i] = static_cast<std::byte>(value);
      else
        std::memcpy(&bytes_[2 * i], &value, 2);
    }
  }
  ImageView view() const { return {bytes_.data(), shape_}; }

 private:
  // Light that falls onto a pixel from `at` on, of a line profile with peak 1.
  static double share(double at, double sigma) {
    const double scale = 1 / (sigma * std::sqrt(2.0));
    return sigma * std::sqrt(std::acos(-1.0) / 2) * (std::erf((at + 0.5) * scale) - std::erf((at - 0.5) * scale));
  }
  void add(const PaintedSpot& spot, std::vector<double>& light) const {
    const double reach = 5 * spot.sigma_px + 1;
    const auto first = [](double at) { return static_cast<std::int64_t>(std::max(at, 0.0)); };
    const auto last = [](double at, std::uint32_t size) { return std::min(static_cast<std::int64_t>(at), size - 1L); };
    for (auto y = first(spot.y_px - reach); y <= last(spot.y_px + reach, shape_.height_px); ++y)
      for (auto x = first(spot.x_px - reach); x <= last(spot.x_px + reach, shape_.width_px); ++x)
        light[static_cast<std::size_t>(y * shape_.width_px + x)] +=
            spot.peak * share(static_cast<double>(x) - spot.x_px, spot.sigma_px) *
            share(static_cast<double>(y) - spot.y_px, spot.sigma_px);
  }

  ImageShape shape_;
  std::vector<std::byte> bytes_;
};

}  // namespace rptv::testing
