// SPDX-License-Identifier: MIT
// A Gaussian integrated over square pixels: its share of each pixel, in lanes. Sources that use it are compiled with
// -Wno-psabi.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "reconstruct/detection/lanes.hpp"
#include "reconstruct/multi_view/view_spot.hpp"

namespace rptv {

using SpotLanes = LaneTypes<8>::Lanes;

/// Along one axis, of `8 · chunks` pixels from `first` on. Shares add up to 1: the outermost pixels have the tails.
struct SpotShares {
  static constexpr std::size_t kMost = 24;
  static constexpr float kReachSigmas = 3.2F;
  alignas(32) float share[kMost], slope[kMost];  ///< slope: derivative by the centre, 1/px
  int first;

  /// Blocks of eight pixels that a spot needs, and how far it is seen from the pixel below its centre.
  static std::size_t chunks(float sigma_px) noexcept {
    const float pixels = 2 * kReachSigmas * sigma_px + 1;
    return std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(pixels / 8)), 1, kMost / 8);
  }
  static int reach_px(float sigma_px) noexcept { return static_cast<int>(std::ceil(kReachSigmas * sigma_px)); }
};

/// erf by Abramowitz & Stegun 7.1.26, within 1.5e-7.
RPTV_LANES void fill_shares(SpotShares& axis, float centre_px, float sigma_px, std::size_t chunks) noexcept {
  constexpr float kPerRoot2 = 0.70710678F, kPerRoot2Pi = 0.39894228F;
  alignas(32) float below[SpotShares::kMost + 1], density[SpotShares::kMost + 1];
  const auto half = static_cast<int>(4 * chunks) - 1;
  axis.first = static_cast<int>(std::floor(centre_px)) - half;
  const float per_sigma = 1 / sigma_px;
  const float offset = static_cast<float>(axis.first) - 0.5F - centre_px;
  for (std::size_t c = 0; c < chunks; ++c) {
    const SpotLanes lane = SpotLanes{0, 1, 2, 3, 4, 5, 6, 7} + static_cast<float>(8 * c);
    const SpotLanes edge = (lane + offset) * per_sigma;
    const SpotLanes x = most(edge, -edge) * kPerRoot2;
    const SpotLanes bell = exp_of(-x * x);
    const SpotLanes t = 1.0F / (1.0F + x * 0.3275911F);
    const SpotLanes series =
        ((((t * 1.061405429F - 1.453152027F) * t + 1.421413741F) * t - 0.284496736F) * t + 0.254829592F) * t;
    const SpotLanes magnitude = 0.5F - series * bell * 0.5F;
    const SpotLanes signed_half = edge < 0.0F ? -magnitude : magnitude;
    const SpotLanes height = bell * (kPerRoot2Pi * per_sigma);
    __builtin_memcpy(below + 8 * c, &signed_half, sizeof signed_half);
    __builtin_memcpy(density + 8 * c, &height, sizeof height);
  }
  below[0] = -0.5F, density[0] = 0;
  below[8 * chunks] = 0.5F, density[8 * chunks] = 0;
  for (std::size_t i = 0; i < 8 * chunks; ++i) {
    axis.share[i] = below[i + 1] - below[i];
    axis.slope[i] = density[i] - density[i + 1];
  }
}

/// A spot's shares on both axes, and the rows that count.
struct SpotPatch {
  SpotShares across, down;
  std::size_t chunks, row_from, row_to;
};

RPTV_LANES void fill_patch(SpotPatch& patch, const ViewSpot& spot) noexcept {
  patch.chunks = SpotShares::chunks(spot.sigma_px);
  fill_shares(patch.across, spot.u_px, spot.sigma_px, patch.chunks);
  fill_shares(patch.down, spot.v_px, spot.sigma_px, patch.chunks);
  const int half = static_cast<int>(4 * patch.chunks) - 1;
  const int reach = std::min(SpotShares::reach_px(spot.sigma_px), half);
  patch.row_from = static_cast<std::size_t>(half - reach);
  patch.row_to = static_cast<std::size_t>(half + reach + 2);
}

}  // namespace rptv
