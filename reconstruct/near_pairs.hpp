// SPDX-License-Identifier: MIT
// Pairs of pixels that are near each other, from a list in raster order.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "reconstruct/lit_maxima.hpp"

namespace rptv {

inline constexpr std::int32_t kMostReach = 15;

/// visit(i, j) for every i < j whose columns and whose rows differ by at most `reach` (up to kMostReach). Each row
/// above j has a cursor, which only ever moves on, as j does.
template <class Visit>
void each_near_pair(std::span<const PixelIndex> sorted, std::int32_t reach, const Visit& visit) noexcept {
  std::array<std::size_t, kMostReach + 1> cursor{};
  for (std::size_t j = 0; j < sorted.size(); ++j)
    for (std::int32_t up = 0; up <= reach; ++up) {
      const std::int32_t y = sorted[j].y - up, first_x = sorted[j].x - reach, last_x = sorted[j].x + reach;
      std::size_t& i = cursor[static_cast<std::size_t>(up)];
      while (i < j && (sorted[i].y < y || (sorted[i].y == y && sorted[i].x < first_x))) ++i;
      for (std::size_t near = i; near < j && sorted[near].y == y && sorted[near].x <= last_x; ++near) visit(near, j);
    }
}

}  // namespace rptv
