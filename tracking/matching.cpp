// SPDX-License-Identifier: MIT
// Trivial choices first, then one subnetwork at a time; the oversize ones wait and are taken apart together.
#include "tracking/matching.hpp"

#include <algorithm>

namespace rptv {

namespace {
constexpr std::size_t kSmall = 64;  // tracks: always solved, whatever the clock says

double stop_share(const LinkerSettings& settings) {
  if (settings.adaptive_stop_mm <= 0) return 1;
  double share = 0;
  for (const double range : settings.range_mm()) share = std::max(share, settings.adaptive_stop_mm / range);
  return share;
}
}  // namespace

Matching::Matching(const LinkerSettings& settings, std::size_t max_tracks, std::size_t max_particles)
    : most_tracks_(settings.max_subnet > 0 && settings.adaptive_stop_mm > 0
                       ? static_cast<std::size_t>(settings.max_subnet)
                       : SIZE_MAX),
      step_(settings.adaptive_step),
      stop_(stop_share(settings)),
      candidates_(max_tracks, max_particles, static_cast<std::size_t>(settings.max_candidates)),
      subnets_(max_tracks, max_particles),
      assignment_(max_tracks, max_particles),
      contested_(max_tracks),
      pending_(max_tracks),
      settled_(max_tracks) {}

void Matching::match(const CellGrid& grid, std::span<const Spot> expected, const Gate* gate, Deadline& deadline,
                     LinkerCounters& counters) noexcept {
  candidates_.find(grid, expected, gate, deadline);
  counters.truncated_searches = candidates_.truncated();
  settle_trivial(expected.size());
  subnets_.split(candidates_, {contested_.data(), disputed_});
  counters.subnets += subnets_.size();
  pending_count_ = 0;
  for (std::size_t net = 0; net < subnets_.size(); ++net) {
    const auto subnet = subnets_[net];
    counters.largest_subnet = std::max<std::uint64_t>(counters.largest_subnet, subnet.size());
    if (oversize(subnet.size(), deadline))
      pending_count_ = static_cast<std::size_t>(
          std::copy(subnet.begin(), subnet.end(), pending_.begin() + static_cast<std::ptrdiff_t>(pending_count_)) -
          pending_.begin());
    else
      solve(subnet, 1.0, deadline, counters);
  }
  if (pending_count_ > 0) adapt(deadline, counters);
}

/// A track whose nearest particle nobody else can want takes it, and its other candidates are free of it: that may
/// leave another track alone with its nearest, and so on.
void Matching::settle_trivial(std::size_t sources) noexcept {
  std::fill_n(settled_.begin(), sources, std::uint8_t{0});
  for (std::uint32_t s = 0; s < sources; ++s) {
    const auto row = candidates_.of(s);
    if (row.empty()) {
      assignment_.settle(s, kNone);
      settled_[s] = 1;
    } else if (settled_[s] == 0 && candidates_.demand(row.front().place) == 1) {
      settle_nearest(s);
    }
  }
  disputed_ = 0;
  for (std::uint32_t s = 0; s < sources; ++s) {
    contested_[disputed_] = s;
    disputed_ += settled_[s] == 0 ? 1 : 0;
  }
}

void Matching::settle_nearest(std::uint32_t source) noexcept {
  std::size_t waiting = 0;
  contested_[waiting++] = source;  // as a stack: a track is on it once at most, for it is settled when it is put there
  settled_[source] = 1;
  while (waiting > 0) {
    const std::uint32_t s = contested_[--waiting];
    const auto row = candidates_.of(s);
    assignment_.settle(s, row.front().place);
    for (const Candidate& c : row.subspan(1)) {
      const std::uint32_t last = candidates_.release(s, c.place);
      if (last == CellGrid::kNone || settled_[last] != 0 || candidates_.of(last).front().place != c.place) continue;
      settled_[last] = 1;
      contested_[waiting++] = last;
    }
  }
}

bool Matching::oversize(std::size_t tracks, Deadline& deadline) const noexcept {
  return tracks > most_tracks_ || (tracks > kSmall && deadline.passed(static_cast<std::uint32_t>(tracks)));
}

void Matching::solve(std::span<const std::uint32_t> subnet, double most_cost, Deadline& deadline,
                     LinkerCounters& counters) noexcept {
  if (!assignment_.solve(candidates_, subnet, most_cost, deadline)) ++counters.cut_subnets;
}

/// Round by round, the range shrinks for all that is pending, which is split anew and solved where small enough.
void Matching::adapt(Deadline& deadline, LinkerCounters& counters) noexcept {
  for (double range = 1; pending_count_ > 0;) {
    if (range <= stop_) return give_up(counters);
    range *= step_;
    std::sort(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(pending_count_));
    disputed_ = 0;
    for (std::size_t i = 0; i < pending_count_; ++i) {
      candidates_.shorten(pending_[i], range * range);
      assignment_.settle(pending_[i], kNone);
      if (!candidates_.of(pending_[i]).empty()) contested_[disputed_++] = pending_[i];
    }
    subnets_.split(candidates_, {contested_.data(), disputed_});
    pending_count_ = 0;
    for (std::size_t net = 0; net < subnets_.size(); ++net) {
      const auto subnet = subnets_[net];
      if (oversize(subnet.size(), deadline)) {
        for (const std::uint32_t s : subnet) pending_[pending_count_++] = s;
      } else {
        solve(subnet, range * range, deadline, counters);
        ++counters.adapted_subnets;
      }
    }
  }
}

void Matching::give_up(LinkerCounters& counters) noexcept {
  std::sort(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(pending_count_));
  subnets_.split(candidates_, {pending_.data(), pending_count_});
  for (std::size_t net = 0; net < subnets_.size(); ++net) {
    assignment_.approximate(candidates_, subnets_[net], 1.0);
    ++counters.cut_subnets;
  }
}

}  // namespace rptv
