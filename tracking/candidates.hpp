// SPDX-License-Identifier: MIT
// Which particles each track could be: the sparse cost matrix of the assignment.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "tracking/cell_grid.hpp"
#include "tracking/deadline.hpp"

namespace rptv {

/// A possible link of a track to the particle at `place` in the grid; cost in units of the search range squared.
using Candidate = Near;

/// Where a track is looked for, mm.
struct Spot {
  double x_mm = 0, y_mm = 0, z_mm = 0;
};

/// A further condition on candidates, beside the search range.
class Gate {
 public:
  virtual ~Gate() = default;
  virtual bool admits(std::size_t source, std::uint32_t place) const noexcept = 0;
};

/// For every track the nearest `max_per_source` particles within the search range, nearest first. A track that has
/// more is counted: the assignment is exact for the links listed here. One thread; find() does not allocate.
class Candidates {
 public:
  /// After this many particles in range a search ends, and counts as truncated.
  static constexpr std::size_t kMostFound = 4096;

  Candidates(std::size_t max_sources, std::size_t max_targets, std::size_t max_per_source);

  /// A row for each expected position; `grid` holds the particles. `gate` may be null. Past the deadline, searches
  /// take the first particles that they meet.
  void find(const CellGrid& grid, std::span<const Spot> expected, const Gate* gate, Deadline& deadline) noexcept;

  std::span<const Candidate> of(std::size_t source) const noexcept {
    return {list_.get() + rows_[source].begin, rows_[source].length};
  }
  /// Tracks that list this target and have not been released.
  std::uint32_t demand(std::size_t target) const noexcept { return demand_[target].count; }
  /// `source` no longer wants `target`. Returns the only source that still does, or kNone.
  std::uint32_t release(std::uint32_t source, std::uint32_t target) noexcept {
    Demand& demand = demand_[target];
    demand.sources ^= source;
    return --demand.count == 1 ? demand.sources : CellGrid::kNone;
  }
  /// Drops the candidates of `source` that cost more.
  void shorten(std::uint32_t source, double most_cost) noexcept {
    Row& row = rows_[source];
    while (row.length > 0 && list_[row.begin + row.length - 1].cost > most_cost) --row.length;
  }
  std::uint64_t truncated() const noexcept { return truncated_; }  ///< searches cut short since construction

 private:
  struct Row {
    std::size_t begin = 0;
    std::uint32_t length = 0;
  };
  struct Demand {
    std::uint32_t count = 0;
    std::uint32_t sources = 0;  // all of them, combined by exclusive or: the last one left is known
  };
  std::uint32_t sort_nearest(Near* row, std::size_t found) noexcept;

  std::size_t max_per_source_, most_found_;
  std::vector<Row> rows_;
  std::unique_ptr<Candidate[]> list_;  // worst case, and untouched beyond what frames have needed
  std::vector<Demand> demand_;
  std::uint64_t truncated_ = 0;
};

}  // namespace rptv
