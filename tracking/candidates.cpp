// SPDX-License-Identifier: MIT
// Searches the grid round every expected position and keeps the nearest particles in order of distance.
#include "tracking/candidates.hpp"

#include <algorithm>

namespace rptv {

Candidates::Candidates(std::size_t max_sources, std::size_t max_targets, std::size_t max_per_source)
    : max_per_source_(max_per_source),
      begin_(max_sources + 1),
      list_(max_sources * max_per_source),
      demand_(max_targets) {}

void Candidates::find(const CellGrid& grid, const Positions& expected, std::size_t sources) noexcept {
  std::fill_n(demand_.begin(), grid.size(), 0U);
  std::size_t end = 0;
  for (std::size_t s = 0; s < sources; ++s) {
    begin_[s] = end;
    end += search(grid, expected.x_mm[s], expected.y_mm[s], expected.z_mm[s], static_cast<std::uint32_t>(s),
                  list_.data() + end);
    for (std::size_t k = begin_[s]; k < end; ++k) ++demand_[list_[k].target];
  }
  begin_[sources] = end;
}

/// Fills `row` by insertion and returns its length. Equal costs keep the grid's order, which starts elsewhere for every
/// source where particles are crowded: sources at one point then list different particles.
std::uint32_t Candidates::search(const CellGrid& grid, double x, double y, double z, std::uint32_t source,
                                 Candidate* row) noexcept {
  std::size_t length = 0;
  std::size_t visited = 0;
  grid.visit_near(x, y, z, source, [&](std::uint32_t target, double cost) noexcept {
    ++visited;
    if (length == max_per_source_) {
      if (cost >= row[length - 1].cost) return visited < kMostVisited;
      --length;
    }
    std::size_t k = length++;
    for (; k > 0 && row[k - 1].cost > cost; --k) row[k] = row[k - 1];
    row[k] = {cost, target};
    return visited < kMostVisited;
  });
  if (visited > max_per_source_) ++truncated_;
  return static_cast<std::uint32_t>(length);
}

}  // namespace rptv
