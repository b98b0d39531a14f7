// SPDX-License-Identifier: MIT
// Searches the grid round every expected position and keeps the nearest particles in order of distance.
#include "tracking/candidates.hpp"

#include <algorithm>

namespace rptv {

Candidates::Candidates(std::size_t max_sources, std::size_t max_targets, std::size_t max_per_source)
    : max_per_source_(max_per_source),
      most_found_(std::min(max_targets, kMostFound)),
      rows_(max_sources),
      list_(std::make_unique_for_overwrite<Candidate[]>(max_sources * max_per_source + most_found_ + CellGrid::kSlack)),
      demand_(max_targets) {}

void Candidates::find(const CellGrid& grid, std::span<const Spot> expected, const Gate* gate,
                      Deadline& deadline) noexcept {
  std::fill_n(demand_.begin(), grid.size(), Demand{});
  std::size_t end = 0;
  std::size_t most = most_found_;
  for (std::size_t s = 0; s < expected.size(); ++s) {
    Near* const row = list_.get() + end;
    std::size_t found = grid.find_near(expected[s].x_mm, expected[s].y_mm, expected[s].z_mm, s, row, most);
    if (deadline.passed(static_cast<std::uint32_t>(found))) most = std::min(most, max_per_source_);
    if (found == most && most < most_found_) ++truncated_;
    if (gate != nullptr)
      found = static_cast<std::size_t>(
          std::remove_if(row, row + found, [&](const Near& n) noexcept { return !gate->admits(s, n.place); }) - row);
    rows_[s] = {end, found < 2 ? static_cast<std::uint32_t>(found) : sort_nearest(row, found)};
    end += rows_[s].length;
    for (std::uint32_t k = 0; k < rows_[s].length; ++k) {
      Demand& demand = demand_[row[k].place];
      ++demand.count;
      demand.sources ^= static_cast<std::uint32_t>(s);
    }
  }
}

/// Equal costs keep the grid's order, which begins elsewhere for every source where particles are crowded: sources at
/// one point then list different particles. Returns how many of them are kept.
std::uint32_t Candidates::sort_nearest(Near* row, std::size_t found) noexcept {
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
  return static_cast<std::uint32_t>(length);
}

}  // namespace rptv
