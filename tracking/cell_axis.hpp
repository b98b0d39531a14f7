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
  double last = 0;  ///< index of the last cell

  std::uint32_t cell(double v) const noexcept {
    return static_cast<std::uint32_t>(std::clamp((v - origin) * cells_per_unit, 0.0, last));
  }
  /// Cells lo … hi hold everything from v − reach to v + reach; false when v is not finite.
  bool range(double v, double reach, std::uint32_t& lo, std::uint32_t& hi) const noexcept {
    if (!std::isfinite(v)) return false;
    lo = cell(v - reach);
    hi = cell(v + reach);
    return true;
  }
};

}  // namespace rptv
