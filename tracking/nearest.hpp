// SPDX-License-Identifier: MIT
// Finds the nearest point of some kind in a grid, within a bounded number of cells.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <limits>

#include "tracking/cell_grid.hpp"

namespace rptv {

template <class Accept>
std::uint32_t CellGrid::find_nearest(double qx, double qy, double qz, Accept&& accept) const noexcept {
  if (hashed_ || !((qx - qx) + (qy - qy) + (qz - qz) == 0)) return kNone;
  constexpr std::uint32_t kMostPerCell = 64;
  const std::int64_t at[3] = {axes_[0].cell(qx), axes_[1].cell(qy), axes_[2].cell(qz)};
  const double edge = 1.0 / (axes_[0].cells_per_unit * reach_[0]);  // in ranges; the same along all axes
  std::uint32_t nearest = kNone;
  double least = std::numeric_limits<double>::infinity();
  for (std::int64_t shell = 0; shell <= kShells; ++shell) {
    const double inside = static_cast<double>(shell - 1) * edge;  // every cell of this shell is at least as far
    if (nearest != kNone && shell > 0 && inside * inside >= least) break;
    std::int64_t lo[3], hi[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lo[axis] = std::max<std::int64_t>(at[axis] - shell, 0);
      hi[axis] = std::min<std::int64_t>(at[axis] + shell, static_cast<std::int64_t>(axes_[axis].last));
    }
    for (std::int64_t iz = lo[2]; iz <= hi[2]; ++iz)
      for (std::int64_t iy = lo[1]; iy <= hi[1]; ++iy) {
        const bool face = std::max(std::abs(iz - at[2]), std::abs(iy - at[1])) == shell;
        for (std::int64_t ix = lo[0]; ix <= hi[0]; ++ix) {
          if (!face && std::abs(ix - at[0]) != shell) continue;
          const auto cell = static_cast<std::size_t>((iz * rows_ + iy) * columns_ + ix);
          const std::uint32_t end = std::min(cell_begin_[cell + 1], cell_begin_[cell] + kMostPerCell);
          for (std::uint32_t place = cell_begin_[cell]; place < end; ++place) {
            if (!accept(place)) continue;
            const double dx = (x_[place] - qx) * per_range_[0];
            const double dy = (y_[place] - qy) * per_range_[1];
            const double dz = (z_[place] - qz) * per_range_[2];
            const double cost = dx * dx + dy * dy + dz * dz;
            if (cost < least) {
              least = cost;
              nearest = place;
            }
          }
        }
      }
  }
  return nearest;
}

}  // namespace rptv
