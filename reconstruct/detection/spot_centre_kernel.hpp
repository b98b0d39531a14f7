// SPDX-License-Identifier: MIT
// A spot's centre by the method that is asked for, and by others where that finds none.
#pragma once

#include "reconstruct/detection/gaussian_spot_kernel.hpp"
#include "reconstruct/detection/light_centre_kernel.hpp"
#include "reconstruct/detection/three_point_kernel.hpp"

namespace rptv {

/// `light` becomes the sum over the square.
template <class Square, class V = typename Square::Value>
RPTV_LANES SpotCentre<V> find_centre(const Square& square, V& light) noexcept {
  const SpotMethod method = square.options.method;
  SpotCentre<V> centre{};
  centre.good = V{} != V{};
  if (method == SpotMethod::three_point) centre = three_point_centre(square);
  if (method != SpotMethod::centroid && centre.any_bad()) centre.replace_bad(gaussian_centre(square));
  if (centre.any_bad()) centre.replace_bad(light_centre(square));
  light = V{};
  each_pixel(
      square.options, [&](std::size_t k, float, float) __attribute__((always_inline)) { light += square.grey(k); });
  return centre;
}

}  // namespace rptv
