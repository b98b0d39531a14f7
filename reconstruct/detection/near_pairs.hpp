// SPDX-License-Identifier: MIT
// Pairs of pixels that are near each other, from a list in raster order.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <span>

#include "reconstruct/detection/near_columns.hpp"

namespace rptv {

inline constexpr std::int32_t kMostReach = 20;

/// visit(i, j) for every i < j whose columns and whose rows differ by at most `reach` (up to kMostReach). The order is
/// not said. Two ways to the same: where few pixels lie in as many rows, it is quickest to look at all of them; where
/// many do, each row above j has a cursor, which only ever moves on, as j does.
template <class Visit>
void each_near_pair(std::span<const PixelIndex> sorted, std::int32_t reach, NearColumns near_columns,
                    const Visit& visit) noexcept {
  constexpr std::size_t kFew = 192, kAtOnce = 64;
  std::array<std::size_t, kMostReach + 1> cursor{};
  std::size_t first = 0;  // of the rows from j's row - reach on
  for (std::size_t j = 0; j < sorted.size(); ++j) {
    const PixelIndex at = sorted[j];
    while (sorted[first].y < at.y - reach) ++first;
    if (j - first <= kFew) {
      for (std::size_t i = first; i < j; i += kAtOnce)
        for (std::uint64_t near = near_columns(&sorted[i], std::min(kAtOnce, j - i), at.x, reach); near != 0;
             near &= near - 1)
          visit(i + static_cast<std::size_t>(std::countr_zero(near)), j);
      continue;
    }
    for (std::int32_t up = 0; up <= reach; ++up) {
      const std::int32_t y = at.y - up, first_x = at.x - reach, last_x = at.x + reach;
      std::size_t& i = cursor[static_cast<std::size_t>(up)];
      while (i < j && (sorted[i].y < y || (sorted[i].y == y && sorted[i].x < first_x))) ++i;
      for (std::size_t near = i; near < j && sorted[near].y == y && sorted[near].x <= last_x; ++near) visit(near, j);
    }
  }
}

}  // namespace rptv
