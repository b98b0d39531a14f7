// SPDX-License-Identifier: MIT
// Grey values between two maxima, and saturated pixels below one: asked of an image as GreyOverBackground has it.
#pragma once

#include <cstdint>

#include "reconstruct/host_device.hpp"

namespace rptv {

/// Least raw grey value on the straight line between two pixels a and b, both left out.
template <class Grey>
RPTV_HOST_DEVICE float least_between(const Grey& grey, std::int32_t ax, std::int32_t ay, std::int32_t bx,
                                     std::int32_t by) noexcept {
  const std::int32_t dx = bx - ax, dy = by - ay, wide = dx < 0 ? -dx : dx, high = dy < 0 ? -dy : dy;
  const std::int32_t steps = wide < high ? high : wide;
  float lowest = 65535;
  for (std::int32_t k = 1; k < steps; ++k) {
    const std::int32_t x = ax + (2 * k * dx + (dx < 0 ? -steps : steps)) / (2 * steps);
    const std::int32_t y = ay + (2 * k * dy + (dy < 0 ? -steps : steps)) / (2 * steps);
    const auto value = static_cast<float>(grey.raw(grey.index(x, y)));
    lowest = value < lowest ? value : lowest;
  }
  return lowest;
}

/// Centre of light and rows of saturated pixels below the first of them; exact where they are convex.
struct Plateau {
  double x = 0, y = 0, rows = 0;
};

template <class Grey>
RPTV_HOST_DEVICE Plateau plateau_of(const Grey& grey, std::int32_t top_x, std::int32_t top_y) noexcept {
  constexpr std::int32_t kMost = 64;  // pixels aside and rows
  Plateau plateau;
  double pixels = 0;
  const auto saturated = [&](std::int32_t x, std::int32_t y) {
    return x >= 0 && x < grey.width() && grey.saturated(grey.index(x, y));
  };
  std::int32_t middle = top_x;
  for (std::int32_t y = top_y; y < grey.height() && y < top_y + kMost && saturated(middle, y); ++y) {
    std::int32_t first = middle, last = middle;
    while (middle - first < kMost && saturated(first - 1, y)) --first;
    while (last - middle < kMost && saturated(last + 1, y)) ++last;
    const double length = last - first + 1;
    plateau.x += length * (first + last) / 2, plateau.y += length * y, pixels += length;
    ++plateau.rows;
    middle = (first + last) / 2;
  }
  plateau.x /= pixels, plateau.y /= pixels;
  return plateau;
}

}  // namespace rptv
