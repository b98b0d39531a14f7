// SPDX-License-Identifier: MIT
// Images of Gaussian spots with the noise of a camera, and the comparison of what is found with what was painted.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "core/image.hpp"
#include "reconstruct/detections.hpp"

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

/// Found against painted; pairs are one-to-one, nearest first, within `within_px`.
struct SpotScore {
  std::size_t painted = 0, found = 0, pairs = 0;
  double rms_px = 0;               ///< per axis, of the pairs
  double normalised_variance = 0;  ///< mean square of error over its standard error

  double recall() const { return static_cast<double>(pairs) / static_cast<double>(painted); }
  double precision() const { return static_cast<double>(pairs) / static_cast<double>(found); }
};

inline SpotScore score_spots(const Detections& found, const std::vector<PaintedSpot>& spots, double within_px) {
  struct Pair {
    double distance;
    std::size_t found, spot;
  };
  std::vector<Pair> pairs;
  for (std::size_t f = 0; f < found.size(); ++f)
    for (std::size_t s = 0; s < spots.size(); ++s)
      if (const double dx = found.x_px[f] - spots[s].x_px, dy = found.y_px[f] - spots[s].y_px;
          std::abs(dx) <= within_px && std::hypot(dx, dy) <= within_px)
        pairs.push_back({std::hypot(dx, dy), f, s});
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
  std::vector<char> found_used(found.size()), spot_used(spots.size());
  SpotScore score{spots.size(), found.size(), 0, 0, 0};
  for (const auto& [distance, f, s] : pairs) {
    if (found_used[f] != 0 || spot_used[s] != 0) continue;
    found_used[f] = spot_used[s] = 1;
    ++score.pairs;
    score.rms_px += distance * distance / 2;
    score.normalised_variance += distance * distance / (2 * found.sigma_px[f] * found.sigma_px[f]);
  }
  const auto n = static_cast<double>(std::max<std::size_t>(score.pairs, 1));
  score.rms_px = std::sqrt(score.rms_px / n), score.normalised_variance /= n;
  return score;
}

}  // namespace rptv::testing
