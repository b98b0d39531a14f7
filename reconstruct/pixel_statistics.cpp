// SPDX-License-Identifier: MIT
// Huber's clipped mean and the median deviation by stochastic approximation (Robbins and Monro 1951), one pass.
#include "reconstruct/pixel_statistics.hpp"

#include <algorithm>
#include <cmath>

namespace rptv {

namespace {

constexpr float kMedianDeviation = 0.6745F;  // of a normal deviate, in sigmas
constexpr float kGain = 1.17F;  // per unit of ln sigma: one over the slope of the share beyond the median deviation
constexpr float kLeastSigma = 0.29F;        // rounding to grey values alone
constexpr std::int64_t kStartedRounds = 8;  // an image without particles counts as this many

}  // namespace

PixelStatistics::PixelStatistics(std::size_t pixels, double mean, double sigma, std::int64_t window)
    : mean_(pixels, static_cast<float>(mean)), sigma_(pixels, static_cast<float>(sigma)), window_(window), rounds_(0) {}

PixelStatistics::PixelStatistics(std::span<const float> mean, double sigma, std::int64_t window)
    : mean_(mean.begin(), mean.end()),
      sigma_(mean.size(), static_cast<float>(sigma)),
      window_(window),
      rounds_(kStartedRounds) {}

template <class Pixel>
void PixelStatistics::update(std::size_t first, std::span<const Pixel> grey) noexcept {
  float *mean = mean_.data() + first, *sigma = sigma_.data() + first;
  if (rounds_ == 0) {
    for (std::size_t i = 0; i < grey.size(); ++i) mean[i] = static_cast<float>(grey[i]);
    return;
  }
  const float rate = 1.0F / static_cast<float>(std::min(rounds_ + 1, window_));
  for (std::size_t i = 0; i < grey.size(); ++i) {
    const float off = static_cast<float>(grey[i]) - mean[i], most = kMostSigmas * sigma[i];
    mean[i] += rate * std::clamp(off, -most, most);
    const float turn = std::abs(off) > kMedianDeviation * sigma[i] ? kGain : -kGain;
    sigma[i] = std::max(sigma[i] * (1 + rate * turn), kLeastSigma);
  }
}

template void PixelStatistics::update(std::size_t, std::span<const std::uint8_t>) noexcept;
template void PixelStatistics::update(std::size_t, std::span<const std::uint16_t>) noexcept;

}  // namespace rptv
