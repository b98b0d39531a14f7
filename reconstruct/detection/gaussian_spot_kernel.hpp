// SPDX-License-Identifier: MIT
// A Gaussian fitted to a square of pixels: logarithms with weights by noise, then two Gauss-Newton steps.
#pragma once

#include "reconstruct/detection/log_gaussian.hpp"
#include "reconstruct/detection/spot_centre.hpp"

namespace rptv {

/// A start that is no peak is made a wide one, for the steps to try.
template <class V>
RPTV_LANES void bound(LogGaussian<V>& fit) noexcept {
  fit.q = least(most(fit.q, all_lanes<V>(-3)), all_lanes<V>(-0.02F));  // σ from 0.4 to 5 px
}

/// Adds all pixels: noise(k) is the variance of pixel k, and term(k, one over it) its WeightedLog. A division takes as
/// long as ten products, so that there is one for two or three pixels.
template <class V, class Noise, class Term>
RPTV_LANES void add_pixels(std::size_t radius, const Noise& noise, const Term& term,
                           NormalEquations<V>& equations) noexcept {
  RPTV_UNROLL for (std::size_t row = 0; row <= 2 * radius; ++row) {
    const std::size_t k = row * SpotBatch::kRow + radius;
    const V middle = noise(k), before = noise(k - 1), after = noise(k + 1), both = before * after;
    const V per_all = 1.0F / (middle * both), per_both = per_all * middle;
    RowMoments<V> moments(term(k, per_all * both));
    moments.add_pair(1, term(k - 1, per_both * after), term(k + 1, per_both * before));
    RPTV_UNROLL for (std::size_t d = 2; d <= radius; ++d) {
      const V left = noise(k - d), right = noise(k + d), per_pair = 1.0F / (left * right);
      moments.add_pair(static_cast<float>(d), term(k - d, per_pair * right), term(k + d, per_pair * left));
    }
    equations.add_row(static_cast<float>(row) - static_cast<float>(radius), moments);
  }
}

template <class Square, class V = typename Square::Value>
RPTV_LANES SpotCentre<V> gaussian_centre(const Square& square) noexcept {
  constexpr int kSteps = 2;  // a third changes nothing that noise does not hide
  const SpotOptions& options = square.options;
  NormalEquations<V> start;
  add_pixels(
      options.radius, [&](std::size_t k) __attribute__((always_inline)) { return noise_of(options, square.grey(k)); },
      [&](std::size_t k, V per_noise) __attribute__((always_inline)) {
        const V grey = square.grey(k), bright = most(grey, all_lanes<V>(1e-3F));
        const V weight = grey > 0.0F ? square.usable(k) * bright * bright * per_noise : V{};
        return WeightedLog<V>{weight, weight * log_of(bright)};
      },
      start);
  LogGaussian<V> fit = start.solve();
  NormalEquations<V> equations;
  V left{};  // squares of what the model leaves, over their variance
  for (int step = 0; step < kSteps; ++step) {
    bound(fit);
    equations = NormalEquations<V>();
    equations.rr = all_lanes<V>(options.bend_weight);
    equations.tr = equations.rr * options.expected_bend;
    left = V{};
    // A Gaussian is the product of two: one along the columns of the square and one along its rows.
    const typename Square::Profile columns(options.radius, fit.b, fit.q, V{}),
        rows(options.radius, fit.c, fit.q, fit.a);
    const auto model_at = [&](std::size_t k) __attribute__((always_inline)) {
      return columns.value(k % SpotBatch::kRow) * rows.value(k / SpotBatch::kRow);
    };
    add_pixels(
        options.radius, [&](std::size_t k) __attribute__((always_inline)) { return noise_of(options, model_at(k)); },
        [&](std::size_t k, V per_variance) __attribute__((always_inline)) {
          const V logarithm = columns.logarithm(k % SpotBatch::kRow) + rows.logarithm(k / SpotBatch::kRow);
          const V model = model_at(k), off = square.grey(k) - model;
          const V per_noise = square.usable(k) * per_variance, weight = per_noise * model;
          left += per_noise * off * off;
          return WeightedLog<V>{weight * model, weight * (model * logarithm + off)};
        },
        equations);
    fit = equations.solve();
  }
  const V x = fit.b / fit.q * -0.5F, y = fit.c / fit.q * -0.5F;
  const auto reach = static_cast<float>(options.radius);
  const V variance = equations.variance(fit, x, y);
  const LaneTruth<V> good = (x * x < reach * reach) & (y * y < reach * reach) & (fit.q < -0.02F) & (variance > 0.0F) &
                            (variance < 1.0F);  // a pixel off tells nothing
  const V peak = exp_of(fit.a + (fit.b * x + fit.c * y) * 0.5F);
  V usable{};
  each_pixel(
      options, [&](std::size_t k, float, float) __attribute__((always_inline)) { usable += square.usable(k); });
  return {x, y, variance, good, peak, fit.q, left / most(usable - 4.0F, all_lanes<V>(1))};
}

}  // namespace rptv
