// SPDX-License-Identifier: MIT
// Grey values of an image as a detector sees them: raw, over the background, lit or not, and how noisy.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

#include "core/image.hpp"
#include "reconstruct/dark_pixels.hpp"
#include "reconstruct/detection/lit_maxima.hpp"

namespace rptv {

/// Variance of a pixel: that of a dark one, with rounding to whole numbers, and the shot noise of the light.
struct GreyNoise {
  float dark_variance = 1;         ///< grey²
  float grey_per_electron = 0.25;  ///< variance per grey value over the background

  static GreyNoise of(double noise_grey, double electrons_per_grey) noexcept {
    return {static_cast<float>(noise_grey * noise_grey + 1.0 / 12), static_cast<float>(1 / electrons_per_grey)};
  }
  float variance(float over_background) const noexcept {
    return dark_variance + std::max(over_background, 0.0F) * grey_per_electron;
  }
};

/// Pixels of type Pixel over a background of the same size; valid as long as both. Coordinates within the image.
template <class Pixel>
class GreyOverBackground {
 public:
  /// `saturation`: grey value from which a pixel tells nothing; 0: the highest of its type.
  GreyOverBackground(const ImageView& image, const DarkPixels& dark, double saturation) noexcept
      : pixels_(reinterpret_cast<const Pixel*>(image.data)),
        mean_(dark.mean.data()),
        limits_(dark.limit.limits().data()),
        table_(dark.limit.uniform() ? 0 : ~std::size_t{0}),
        width_(static_cast<std::int32_t>(image.shape.width_px)),
        height_(static_cast<std::int32_t>(image.shape.height_px)),
        saturation_(saturation > 0 ? static_cast<float>(saturation)
                                   : static_cast<float>(std::numeric_limits<Pixel>::max())) {}

  std::int32_t width() const noexcept { return width_; }
  std::int32_t height() const noexcept { return height_; }
  std::size_t index(std::int32_t x, std::int32_t y) const noexcept {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  Pixel raw(std::size_t i) const noexcept { return pixels_[i]; }
  float over(std::size_t i) const noexcept { return static_cast<float>(pixels_[i]) - mean_[i & table_]; }
  /// Highest value of over(i) that is still dark.
  float dark(std::size_t i) const noexcept { return static_cast<float>(limits_[i & table_]) - mean_[i & table_]; }
  /// Whole, and above 0 where the pixel is lit.
  float over_limit(std::size_t i) const noexcept {
    return static_cast<float>(pixels_[i]) - static_cast<float>(limits_[i & table_]);
  }
  bool saturated(std::size_t i) const noexcept { return static_cast<float>(pixels_[i]) >= saturation_; }
  // For copies of whole rows: from pixel i on. With one background, mean(i) has one value for all.
  const Pixel* pixels() const noexcept { return pixels_; }
  const float* mean(std::size_t i) const noexcept { return mean_ + (i & table_); }
  bool one_background() const noexcept { return table_ == 0; }
  float saturation() const noexcept { return saturation_; }

  /// Asks for the memory of a square that will be read soon; parts of it may lie outside.
  void prefetch_square(PixelIndex middle, std::int32_t radius) const noexcept {
    __builtin_prefetch(limits_ + (index(middle.x, middle.y) & table_));
    for (std::int32_t y = std::max(middle.y - radius, 0); y <= std::min(middle.y + radius, height_ - 1); ++y) {
      const std::size_t i = index(std::max(middle.x - radius, 0), y);
      __builtin_prefetch(pixels_ + i), __builtin_prefetch(mean_ + (i & table_));
    }
  }

 private:
  const Pixel* pixels_;
  const float* mean_;
  const std::uint16_t* limits_;
  std::size_t table_;  // bits of an index into mean_ and limits_ that count: none where all values are equal
  std::int32_t width_, height_;
  float saturation_;
};

}  // namespace rptv
