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
  constexpr std::uint32_t kMostPerRow = 256;
  const std::int64_t at[3] = {axes_[0].cell(qx), axes_[1].cell(qy), axes_[2].cell(qz)};
  const double edge = 1.0 / (axes_[0].cells_per_unit * reach_[0]);  // in ranges; the same along all axes
  std::uint32_t nearest = kNone;
  double least = std::numeric_limits<double>::infinity();
  const auto look = [&](std::size_t first_cell, std::size_t last_cell) {
    const std::uint32_t begin = cell_begin_[first_cell];
    const std::uint32_t end = std::min(cell_begin_[last_cell + 1], begin + kMostPerRow);
    for (std::uint32_t place = begin; place < end; ++place) {
      const double dx = (x_[place] - qx) * per_range_[0];
      const double dy = (y_[place] - qy) * per_range_[1];
      const double dz = (z_[place] - qz) * per_range_[2];
      const double cost = dx * dx + dy * dy + dz * dz;
      if (cost >= least || !accept(place)) continue;
      least = cost;
      nearest = place;
    }
  };
  for (std::int64_t shell = 1; shell <= kShells; ++shell) {
    const double inside = static_cast<double>(shell - 1) * edge;  // every cell of this shell is at least as far
    if (nearest != kNone && inside * inside >= least) break;
    std::int64_t lo[3], hi[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lo[axis] = std::max<std::int64_t>(at[axis] - shell, 0);
      hi[axis] = std::min<std::int64_t>(at[axis] + shell, static_cast<std::int64_t>(axes_[axis].last));
    }
    for (std::int64_t iz = lo[2]; iz <= hi[2]; ++iz)
      for (std::int64_t iy = lo[1]; iy <= hi[1]; ++iy) {
        const auto row = static_cast<std::size_t>((iz * rows_ + iy) * columns_);
        const auto first = row + static_cast<std::size_t>(lo[0]);
        const auto last = row + static_cast<std::size_t>(hi[0]);
        if (shell == 1 || std::max(std::abs(iz - at[2]), std::abs(iy - at[1])) == shell) {
          look(first, last);  // the whole row is new: shell 1 has the cells inside it, too
          continue;
        }
        if (at[0] - shell >= 0) look(first, first);
        if (at[0] + shell == hi[0]) look(last, last);
      }
  }
  return nearest;
}

}  // namespace rptv
