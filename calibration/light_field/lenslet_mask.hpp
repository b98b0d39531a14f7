// SPDX-License-Identifier: MIT
// Which lenslets were left out of a fit, and which give no rays, each with its reason.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace rptv {

/// Why; several may hold at once (bits).
namespace lenslet_reason {
inline constexpr std::uint8_t kArea = 1;          ///< sub-image smaller than those on the axis: vignetted
inline constexpr std::uint8_t kEccentricity = 2;  ///< not round: a cat's eye
inline constexpr std::uint8_t kResidual = 4;      ///< sub-image is not where the lattice says
inline constexpr std::uint8_t kBrightness = 8;    ///< too little light, or much less than the neighbours
inline constexpr std::uint8_t kBorder = 16;       ///< sub-image is cut by the sensor's border
}  // namespace lenslet_reason

/// "area, eccentricity" for messages; "none" for 0.
std::string reasons_text(std::uint8_t reasons);

/// One value per lenslet (u, v) of the lattice of the calibration, row by row; 0: nothing is wrong.
struct LensletMask {
  std::int64_t first_u = 0, first_v = 0;
  std::int64_t columns = 0, rows = 0;
  std::vector<std::uint8_t> reasons;  ///< columns·rows

  bool empty() const noexcept { return reasons.empty(); }
  bool has(std::int64_t u, std::int64_t v) const noexcept {
    return u >= first_u && v >= first_v && u < first_u + columns && v < first_v + rows;
  }
  /// Where the value of a lenslet that it has is.
  std::size_t place(std::int64_t u, std::int64_t v) const noexcept {
    return static_cast<std::size_t>((v - first_v) * columns + (u - first_u));
  }
  /// Reasons of lenslet (u, v); 0 outside.
  std::uint8_t of(std::int64_t u, std::int64_t v) const noexcept { return has(u, v) ? reasons[place(u, v)] : 0; }
};

}  // namespace rptv
