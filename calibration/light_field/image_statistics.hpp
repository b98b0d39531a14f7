// SPDX-License-Identifier: MIT
// Mean, noise and maximum of images, pixel by pixel, and whether they are saturated: what a calibration is made from.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calibration/grey_image.hpp"

namespace rptv {

/// Sums images of one shape. One thread.
class ImageStatistics {
 public:
  /// `origin` names the image in messages. Throws Error(bad_data) when its shape is not that of the first.
  void add(const ImageView& image, const std::string& origin);

  std::size_t images() const noexcept { return images_; }
  int width() const noexcept { return width_; }
  int height() const noexcept { return height_; }
  GreyImage mean() const;
  GreyImage maximum() const;
  /// Rms over the images of each pixel; from one image: the scatter of all pixels, the same everywhere.
  GreyImage noise() const;
  /// Mean over all pixels and images, and over the pixels' noise.
  double level() const noexcept;
  double mean_noise() const;
  /// Pixels at the highest value that `significant_bits` can hold, in any image, over those above half of it.
  double saturated_share(std::uint32_t significant_bits) const noexcept;

 private:
  int width_ = 0, height_ = 0;
  std::size_t images_ = 0;
  std::vector<double> sum_, squares_;
  std::vector<float> maximum_;
};

/// Dark level per pixel: the mean, or from fewer than four images the level of all with single hot pixels kept.
GreyImage dark_level_of(const ImageStatistics& dark);

/// Which pixels any particle image has lit: 1 or 0. `dark_level` and `dark_noise` in grey values.
GreyImage lit_in_any(const ImageStatistics& images, double dark_level, double dark_noise);

}  // namespace rptv
