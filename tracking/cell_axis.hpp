// SPDX-License-Identifier: MIT
// Cells along one axis: which cell a coordinate is in, and which cells a range meets.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace rptv {

/// Neither cell() nor a rounded difference ever decreases with v, so a range misses no point. Points beyond share the
/// outer cells.
struct CellAxis {
  double origin = 0;
  double cells_per_unit = 0;
  double last = 0;       ///< index of the last cell
  double last_from = 0;  ///< index of the first cell of the last window

  /// v must not be NaN.
  std::uint32_t cell(double v) const noexcept {
    return static_cast<std::uint32_t>(
        static_cast<std::int64_t>(std::min(std::max((v - origin) * cells_per_unit, 0.0), last)));
  }
  /// Where a window of fixed width begins that holds everything from v − reach on; moved inside the grid at its ends.
  std::uint32_t window_from(double v, double reach) const noexcept {
    return static_cast<std::uint32_t>(
        static_cast<std::int64_t>(std::min(std::max((v - reach - origin) * cells_per_unit, 0.0), last_from)));
  }
};

}  // namespace rptv
