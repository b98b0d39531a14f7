// SPDX-License-Identifier: MIT
// The peak of the parabolas through the logarithms of three pixels along a row and along a column.
#pragma once

#include "reconstruct/detection/spot_centre.hpp"

namespace rptv {

template <class V>
struct PeakOfThree {
  V at, variance;
  LaneTruth<V> good;
};

template <class Square, class V = typename Square::Value>
RPTV_LANES PeakOfThree<V> parabola(const Square& square, std::size_t before, std::size_t middle,
                                   std::size_t after) noexcept {
  const SpotOptions& options = square.options;
  const auto floor = [](V grey) __attribute__((always_inline)) { return most(grey, all_lanes<V>(1e-3F)); };
  const V i0 = floor(square.grey(before)), i1 = floor(square.grey(middle)), i2 = floor(square.grey(after));
  const V usable = square.usable(before) * square.usable(middle) * square.usable(after);
  const V l0 = log_of(i0), l1 = log_of(i1), l2 = log_of(i2), bend = l0 - l1 * 2.0F + l2;
  const V at = (l0 - l2) / (bend * 2.0F);
  const V g0 = 1.0F - at * 2.0F, g1 = at * 4.0F, g2 = 1.0F + at * 2.0F;
  const V variance = (g0 * g0 * noise_of(options, i0) / (i0 * i0) + g1 * g1 * noise_of(options, i1) / (i1 * i1) +
                      g2 * g2 * noise_of(options, i2) / (i2 * i2)) /
                     (bend * bend * 4.0F);
  const LaneTruth<V> good =
      (usable > 0.0F) & (bend < 0.0F) & (i0 > 2e-3F) & (i2 > 2e-3F) & (at * at < 1.0F) & (variance < 1.0F);
  return {at, variance, good};
}

template <class Square, class V = typename Square::Value>
RPTV_LANES SpotCentre<V> three_point_centre(const Square& square) noexcept {
  const std::size_t side = SpotBatch::kRow, middle = square.options.radius * (side + 1);
  const PeakOfThree<V> along_x = parabola(square, middle - 1, middle, middle + 1);
  const PeakOfThree<V> along_y = parabola(square, middle - side, middle, middle + side);
  const LaneTruth<V> good = along_x.good & along_y.good;
  return {along_x.at, along_y.at, (along_x.variance + along_y.variance) * 0.5F, good};
}

}  // namespace rptv
