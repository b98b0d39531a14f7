// SPDX-License-Identifier: MIT
// Searches the grid round every expected position and keeps the nearest particles in order of distance.
#include "tracking/candidates.hpp"

#include <algorithm>

namespace rptv {

Candidates::Candidates(std::size_t max_sources, std::size_t max_targets, std::size_t max_per_source)
    : max_per_source_(max_per_source),
      most_found_(std::min(max_targets, kMostFound)),
      begin_(max_sources + 1),
      list_(max_sources * max_per_source + most_found_),
      demand_(max_targets) {}

void Candidates::find(const CellGrid& grid, const Positions& expected, std::size_t sources) noexcept {
  std::fill_n(demand_.begin(), grid.size(), 0U);
  std::size_t end = 0;
  for (std::size_t s = 0; s < sources; ++s) {
    begin_[s] = end;
    end += search(grid, expected, s, list_.data() + end);
    for (std::size_t k = begin_[s]; k < end; ++k) ++demand_[list_[k].place];
  }
  begin_[sources] = end;
}

/// Fills `row` and returns its length. Equal costs keep the grid's order, which begins elsewhere for every source where
/// particles are crowded: sources at one point then list different particles.
std::size_t Candidates::search(const CellGrid& grid, const Positions& expected, std::size_t source,
                               Near* row) noexcept {
  const std::size_t found =
      grid.find_near(expected.x_mm[source], expected.y_mm[source], expected.z_mm[source], source, row, most_found_);
  const auto nearer = [](const Near& a, const Near& b) noexcept { return a.cost < b.cost; };
  std::size_t length = found;
  if (found > max_per_source_) {
    ++truncated_;
    length = max_per_source_;
    std::nth_element(row, row + length, row + found, nearer);
  }
  for (std::size_t i = 1; i < length; ++i) {
    const Near moved = row[i];
    std::size_t k = i;
    for (; k > 0 && nearer(moved, row[k - 1]); --k) row[k] = row[k - 1];
    row[k] = moved;
  }
  return length;
}

}  // namespace rptv
