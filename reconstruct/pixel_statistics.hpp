// SPDX-License-Identifier: MIT
// Mean and noise of every pixel when no particle lights it, kept up from the running images themselves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rptv {

/// A robust running mean and deviation: what lies far from the mean (a particle passes) counts as if it lay
/// `kMostSigmas` away, so that a pixel that is lit f of the time is off by about f·kMostSigmas of its noise, and a
/// wrong start is forgotten. The first updates weigh 1/n, later ones 1/window. One thread.
class PixelStatistics {
 public:
  static constexpr float kMostSigmas = 1.5F;

  /// `mean` and `sigma` (grey values) are where it starts; equal values for all pixels are forgotten at the first
  /// image.
  PixelStatistics(std::size_t pixels, double mean, double sigma, std::int64_t window);
  PixelStatistics(std::span<const float> mean, double sigma, std::int64_t window);

  /// Takes grey values of the pixels first, first + 1, …; call it for all pixels equally often.
  template <class Pixel>
  void update(std::size_t first, std::span<const Pixel> grey) noexcept;
  /// Ends a round of update() calls over the whole image.
  void end_round() noexcept { ++rounds_; }

  std::int64_t rounds() const noexcept { return rounds_; }
  std::span<const float> mean() const noexcept { return mean_; }
  std::span<const float> sigma() const noexcept { return sigma_; }

 private:
  std::vector<float> mean_, sigma_;
  std::int64_t window_, rounds_;
};

}  // namespace rptv
