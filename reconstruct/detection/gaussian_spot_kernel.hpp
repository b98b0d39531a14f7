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

template <class Square, class V = typename Square::Value>
RPTV_LANES SpotCentre<V> gaussian_centre(const Square& square) noexcept {
  constexpr int kSteps = 2;  // a third changes nothing that noise does not hide
  const SpotOptions& options = square.options;
  NormalEquations<V> start;
  each_pixel(
      options, [&](std::size_t k, float dx, float dy) __attribute__((always_inline)) {
        const V grey = square.grey(k), usable = square.usable(k);
        const V bright = most(grey, all_lanes<V>(1e-3F));
        const V weight = grey > 0.0F ? usable * bright * bright / noise_of(options, grey) : V{};
        start.add(dx, dy, weight, weight * log_of(bright));
      });
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
    each_pixel(
        options, [&](std::size_t k, float dx, float dy) __attribute__((always_inline)) {
          const std::size_t column = k % SpotBatch::kRow, row = k / SpotBatch::kRow;
          const V logarithm = columns.logarithm(column) + rows.logarithm(row);
          const V model = columns.value(column) * rows.value(row), off = square.grey(k) - model;
          const V per_noise = square.usable(k) / noise_of(options, model);
          const V weight = per_noise * model;
          equations.add(dx, dy, weight * model, weight * (model * logarithm + off));
          left += per_noise * off * off;
        });
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
