// SPDX-License-Identifier: MIT
// Pixelwise statistics of a stack of images.
#include "calibration/light_field/image_statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.hpp"

namespace rptv {

void ImageStatistics::add(const ImageView& image, const std::string& origin) {
  const GreyImage grey(image);
  if (images_ == 0) {
    width_ = grey.width, height_ = grey.height;
    sum_.resize(grey.grey.size()), squares_.resize(grey.grey.size());
    maximum_ = grey.grey;
  }
  if (grey.width != width_ || grey.height != height_)
    throw Error(ExitCode::bad_data,
                fmt::format("{}: is {}x{} px and the first image is {}x{}; give images of one camera", origin,
                            grey.width, grey.height, width_, height_));
  ++images_;
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    const double value = grey.grey[i];
    sum_[i] += value, squares_[i] += value * value;
    maximum_[i] = std::max(maximum_[i], grey.grey[i]);
  }
}

GreyImage ImageStatistics::mean() const {
  GreyImage mean(width_, height_);
  for (std::size_t i = 0; i < sum_.size(); ++i)
    mean.grey[i] = static_cast<float>(sum_[i] / static_cast<double>(images_));
  return mean;
}

GreyImage ImageStatistics::maximum() const {
  GreyImage maximum(width_, height_);
  maximum.grey = maximum_;
  return maximum;
}

double ImageStatistics::level() const noexcept {
  return std::accumulate(sum_.begin(), sum_.end(), 0.0) /
         (static_cast<double>(images_) * static_cast<double>(sum_.size()));
}

GreyImage ImageStatistics::noise() const {
  const auto n = static_cast<double>(images_);
  if (images_ == 1) {
    const double middle = level();
    double square = 0;
    for (const double value : sum_) square += (value - middle) * (value - middle);
    return {width_, height_, static_cast<float>(std::sqrt(square / static_cast<double>(sum_.size())))};
  }
  GreyImage noise(width_, height_);
  for (std::size_t i = 0; i < sum_.size(); ++i)
    noise.grey[i] = static_cast<float>(std::sqrt(std::max(0.0, (squares_[i] - sum_[i] * sum_[i] / n) / (n - 1))));
  return noise;
}

double ImageStatistics::mean_noise() const {
  const GreyImage all = noise();
  return std::accumulate(all.grey.begin(), all.grey.end(), 0.0) / static_cast<double>(all.grey.size());
}

double ImageStatistics::saturated_share(std::uint32_t significant_bits) const noexcept {
  const auto top = static_cast<float>((std::uint64_t{1} << significant_bits) - 1);
  const auto above = [&](float limit) {
    return static_cast<double>(std::count_if(maximum_.begin(), maximum_.end(), [&](float v) { return v >= limit; }));
  };
  return above(top) / std::max(above(top / 2), 1.0);
}

GreyImage dark_level_of(const ImageStatistics& dark) {
  constexpr std::size_t kEnough = 4;
  constexpr double kHot = 8;  // noises above the level
  GreyImage level = dark.mean();
  if (dark.images() >= kEnough) return level;
  const auto middle = static_cast<float>(dark.level());
  const auto limit = static_cast<float>(dark.level() + kHot * std::max(dark.mean_noise(), 0.3));
  for (float& value : level.grey)
    if (value <= limit) value = middle;
  return level;
}

GreyImage lit_in_any(const ImageStatistics& images, double dark_level, double dark_noise) {
  GreyImage lit = images.maximum();
  std::vector<float> sorted = lit.grey;
  const auto top = sorted.begin() + static_cast<std::ptrdiff_t>(0.9999 * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), top, sorted.end());
  constexpr double kNoises = 6, kShare = 0.1;  // a tenth of the brightest leaves out the tails of diffraction
  const double limit = dark_level + std::max(kNoises * dark_noise, kShare * (*top - dark_level));
  for (float& value : lit.grey) value = value > limit ? 1.0F : 0.0F;
  return lit;
}

}  // namespace rptv
