// SPDX-License-Identifier: MIT
// What the ways to find a spot's centre have in common, for the lanes of V or one number.
#pragma once

#include "reconstruct/detection/lanes.hpp"
#include "reconstruct/detection/spot_fit.hpp"

namespace rptv {

template <class V>
RPTV_LANES V all_lanes(float value) noexcept {
  return V{} + value;
}

/// Pixels from the middle of the square.
template <class V>
struct SpotCentre {
  V x, y, variance;
  LaneTruth<V> good;                       ///< there is a peak within the square
  V peak = V{}, bend = V{}, misfit = V{};  ///< of a Gaussian

  RPTV_LANES void replace_bad(const SpotCentre& by) noexcept {
    x = good ? x : by.x;
    y = good ? y : by.y;
    variance = good ? variance : by.variance;
    peak = good ? peak : by.peak;
    bend = good ? bend : by.bend;
    misfit = good ? misfit : by.misfit;
    good |= by.good;
  }
  RPTV_LANES bool any_bad() const noexcept { return any(good == LaneTruth<V>{}); }
};

/// A square of pixels, as the kernels ask it: grey(k) over the background and usable(k), 0 or 1, of pixel k =
/// (dy + radius)·kRow + dx + radius; options; and Profile, the exponential of a parabola at whole numbers.
/// Variance of a pixel by its light.
template <class V>
RPTV_LANES V noise_of(const SpotOptions& options, V light) noexcept {
  return most(light, V{}) * options.grey_per_electron + options.noise_variance;
}

/// visit(k, dx, dy) for every pixel.
template <class Visit>
RPTV_LANES void each_pixel(const SpotOptions& options, const Visit& visit) noexcept {
  const int radius = static_cast<int>(options.radius);
  RPTV_UNROLL for (int dy = -radius; dy <= radius; ++dy) {
    std::size_t k = static_cast<std::size_t>(dy + radius) * SpotBatch::kRow;
    RPTV_UNROLL for (int dx = -radius; dx <= radius; ++dx) visit(k++, static_cast<float>(dx), static_cast<float>(dy));
  }
}

}  // namespace rptv
