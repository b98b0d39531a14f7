// SPDX-License-Identifier: MIT
// The centre of light of a square of pixels, made up for the light that leaves it over its edges.
#pragma once

#include "reconstruct/detection/spot_centre.hpp"

namespace rptv {

/// Light of the columns (or rows) at both edges of the square and of those beside them, inwards.
template <class V>
struct EdgeLight {
  V outer{}, inner{};

  RPTV_LANES void add(float offset, float radius, V grey) noexcept {
    if (offset * offset == radius * radius) outer += grey;
    if (offset * offset == (radius - 1) * (radius - 1)) inner += radius == 1 ? grey + grey : grey;  // of both sides
  }
  /// What of a shift of the spot its centre of light follows: light leaves the square over one edge and comes in over
  /// the other, half a pixel beyond the outer columns, where light falls off as from the inner to the outer ones.
  RPTV_LANES V follows(float radius, V sum) const noexcept {
    const V floor = sum * 1e-4F, far = most(outer, floor), near = most(inner, far);
    const float beyond = (radius + 0.25F) / (2 * radius - 1);  // by how much more the square of the distance grows
    const V at_edge = exp_of(log_of(far) * (1 + beyond) - log_of(near) * beyond);
    return most(1.0F - at_edge * ((radius + 0.5F) / sum), all_lanes<V>(0.1F));
  }
};

template <class Square, class V = typename Square::Value>
RPTV_LANES SpotCentre<V> light_centre(const Square& square) noexcept {
  const SpotOptions& options = square.options;
  const auto radius = static_cast<float>(options.radius);
  V sum{}, sum_x{}, sum_y{}, spread_x{}, spread_y{};
  EdgeLight<V> columns, rows;
  each_pixel(
      options, [&](std::size_t k, float dx, float dy) __attribute__((always_inline)) {
        const V grey = square.grey(k);
        sum += grey, sum_x += grey * dx, sum_y += grey * dy;
        columns.add(dx, radius, grey), rows.add(dy, radius, grey);
      });
  const V safe = most(sum, all_lanes<V>(1e-3F)), x = sum_x / safe, y = sum_y / safe;
  each_pixel(
      options, [&](std::size_t k, float dx, float dy) __attribute__((always_inline)) {
        const V noise = noise_of(options, square.grey(k));
        spread_x += (x - dx) * (x - dx) * noise, spread_y += (y - dy) * (y - dy) * noise;
      });
  const V per_x = 1.0F / columns.follows(radius, safe), per_y = 1.0F / rows.follows(radius, safe);
  const V lowest = all_lanes<V>(-radius), highest = all_lanes<V>(radius);
  const V variance = (spread_x * per_x * per_x + spread_y * per_y * per_y) / (safe * safe) * 0.5F;
  const LaneTruth<V> good = V{} == V{};
  return {least(most(x * per_x, lowest), highest), least(most(y * per_y, lowest), highest), variance, good};
}

}  // namespace rptv
