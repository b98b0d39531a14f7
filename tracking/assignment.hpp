// SPDX-License-Identifier: MIT
// Exact minimum-cost assignment of tracks to particles in one subnetwork, with the choice of staying unlinked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tracking/candidates.hpp"

namespace rptv {

/// Minimises Σ cost over links + unlinked_cost per track without one; each particle goes to at most one track.
/// Sparse form of Jonker & Volgenant, Computing 38 (1987) 325: greedy start, augmenting row reduction, then for every
/// track left one shortest augmenting path (Dijkstra on reduced costs). O(n·m·log n) for n tracks and m candidates.
/// Instead of a dense matrix with dummies, each track has a private dummy particle of cost unlinked_cost.
/// One thread; nothing allocates after construction.
class Assignment {
 public:
  static constexpr std::uint32_t kNone = UINT32_MAX;

  Assignment(std::size_t max_sources, std::size_t max_targets);

  /// Solves one subnetwork; target_of() of its tracks is then valid until they are solved again. False when the
  /// deadline came first: tracks not yet reached then have the nearest particle that is left over, or none.
  bool solve(const Candidates& candidates, std::span<const std::uint32_t> subnet, double unlinked_cost,
             Deadline& deadline) noexcept;
  /// The same without any augmenting path: a valid assignment in O(candidates), seldom the cheapest.
  void approximate(const Candidates& candidates, std::span<const std::uint32_t> subnet, double unlinked_cost) noexcept;
  /// A track that needs no solving: its own particle, or kNone.
  void settle(std::uint32_t source, std::uint32_t target) noexcept { target_of_[source] = target; }

  std::uint32_t target_of(std::size_t source) const noexcept { return target_of_[source]; }

 private:
  struct Target {
    double price = 0;       // dual variable, ≤ 0; 0 while nobody owns it
    double owner_cost = 0;  // cost of the link to its owner
    double distance = 0;    // shortest path found so far in this search
    double via_cost = 0;    // cost of the last link of that path
    std::uint32_t owner = kNone;
    std::uint32_t via = kNone;  // the track before it on that path
    std::uint32_t heap_at = 0;  // place in the heap, or kDone
    std::uint32_t search = 0;   // the search that the fields above belong to
  };
  struct Choice {
    std::uint32_t target;  // kNone: to stay unlinked
    double cost;
    double gain;  // how much better than the second best
  };
  struct PathEnd {
    double distance;
    std::uint32_t target;  // kNone: the path ends with `source` unlinked
    std::uint32_t source;
  };
  static constexpr std::uint32_t kDone = UINT32_MAX;

  void start_greedily(const Candidates& candidates, std::span<const std::uint32_t> subnet) noexcept;
  void reduce_rows(const Candidates& candidates, std::size_t most_steps) noexcept;
  Choice best_choice(std::span<const Candidate> row) const noexcept;
  bool augment(const Candidates& candidates, std::uint32_t source, Deadline& deadline) noexcept;
  void take_left_over(const Candidates& candidates) noexcept;
  void relax(std::span<const Candidate> row, std::uint32_t source, double offset, PathEnd& end) noexcept;
  void flip(const PathEnd& end, std::uint32_t start) noexcept;
  void own(std::uint32_t source, std::uint32_t target, double cost) noexcept;
  void push_or_raise(std::uint32_t target) noexcept;
  std::uint32_t pop() noexcept;

  double unlinked_cost_ = 1;
  std::uint32_t search_ = 0;
  std::vector<std::uint32_t> target_of_;
  std::vector<Target> targets_;
  std::vector<std::uint32_t> free_, heap_, done_;
  std::size_t free_count_ = 0, heap_size_ = 0, done_count_ = 0;
};

}  // namespace rptv
