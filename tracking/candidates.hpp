// SPDX-License-Identifier: MIT
// Which particles each track could be: the sparse cost matrix of the assignment.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tracking/cell_grid.hpp"
#include "tracking/predictor.hpp"

namespace rptv {

/// A possible link of a track to the particle at `place` in the grid. cost = d² / search_range².
using Candidate = Near;

/// For every track the nearest `max_per_source` particles within the search range, nearest first. A track that has
/// more is counted: the assignment is exact for the links listed here. One thread; find() does not allocate.
class Candidates {
 public:
  /// After this many particles in range a search ends, and counts as truncated.
  static constexpr std::size_t kMostFound = 4096;

  Candidates(std::size_t max_sources, std::size_t max_targets, std::size_t max_per_source);

  /// Rows for the first `sources` expected positions; `grid` holds the particles.
  void find(const CellGrid& grid, const Positions& expected, std::size_t sources) noexcept;

  std::span<const Candidate> of(std::size_t source) const noexcept {
    return {list_.data() + begin_[source], list_.data() + begin_[source + 1]};
  }
  /// Tracks that list this target.
  std::uint32_t demand(std::size_t target) const noexcept { return demand_[target]; }
  std::uint64_t truncated() const noexcept { return truncated_; }  ///< searches cut short since construction

 private:
  std::size_t search(const CellGrid& grid, const Positions& expected, std::size_t source, Near* row) noexcept;

  std::size_t max_per_source_, most_found_;
  std::vector<std::size_t> begin_;
  std::vector<Candidate> list_;
  std::vector<std::uint32_t> demand_;
  std::uint64_t truncated_ = 0;
};

}  // namespace rptv
