// SPDX-License-Identifier: MIT
// Which track goes on with which particle: candidates, trivial choices, subnetworks, assignment, adaptive search.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tracking/assignment.hpp"
#include "tracking/candidates.hpp"
#include "tracking/linker_counters.hpp"
#include "tracking/linker_settings.hpp"
#include "tracking/subnet.hpp"

namespace rptv {

/// The cheapest set of links of one frame; see Linker. Where a subnetwork of more than max_subnet tracks, or one that
/// is met past the deadline, may not be solved at the full range, the range shrinks for its tracks by adaptive_step
/// until it falls apart (as trackpy does), at most down to adaptive_stop; what is then still too large, or all of it
/// without adaptive_stop, gets an approximate assignment. Both are counted. One thread; match() does not allocate.
class Matching {
 public:
  static constexpr std::uint32_t kNone = Assignment::kNone;

  /// Settings must have been checked.
  Matching(const LinkerSettings& settings, std::size_t max_tracks, std::size_t max_particles);

  /// `expected`: where each track is looked for; `grid`: the particles; `gate` may be null. Counts into `counters`.
  void match(const CellGrid& grid, std::span<const Spot> expected, const Gate* gate, Deadline& deadline,
             LinkerCounters& counters) noexcept;

  /// Place in the grid of the particle that track `source` goes on with, or kNone.
  std::uint32_t target_of(std::size_t source) const noexcept { return assignment_.target_of(source); }

 private:
  void settle_trivial(std::size_t sources) noexcept;
  void settle_nearest(std::uint32_t source) noexcept;
  bool oversize(std::size_t tracks, Deadline& deadline) const noexcept;
  void solve(std::span<const std::uint32_t> subnet, double most_cost, Deadline& deadline,
             LinkerCounters& counters) noexcept;
  void adapt(Deadline& deadline, LinkerCounters& counters) noexcept;
  void give_up(LinkerCounters& counters) noexcept;

  std::size_t most_tracks_;     // in a subnetwork that is solved at the full range
  double step_ = 1, stop_ = 1;  // of the range, as a share of it; stop_ = 1: no adaptive search
  Candidates candidates_;
  Subnets subnets_;
  Assignment assignment_;
  std::vector<std::uint32_t> contested_, pending_;
  std::vector<std::uint8_t> settled_;
  std::size_t disputed_ = 0, pending_count_ = 0;
};

}  // namespace rptv
