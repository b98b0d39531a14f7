// SPDX-License-Identifier: MIT
// Short words for tests of the linker: positions in, identities out, and the cost by brute force.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "tracking/linker.hpp"

namespace rptv {

using Position = std::array<double, 3>;
using Positions3 = std::vector<Position>;

inline constexpr std::int64_t kPeriodNs = 10'000'000;

inline Particles particles_at(const Positions3& positions) {
  Particles particles(positions.size());
  for (const Position& p : positions) particles.push({p[0], p[1], p[2], 0, 0, {}});
  return particles;
}

inline LinkerSettings settings_for(double search_range_mm, std::int64_t memory = 0, const char* predict = "none") {
  LinkerSettings settings;
  settings.search_range_mm = search_range_mm;
  settings.memory = memory;
  settings.predict = predict;
  settings.deadline_ms = 0;
  settings.max_particles = settings.max_tracks = 1000;
  return settings;
}

/// A linker with its output, fed at 100 Hz unless told otherwise.
struct Session {
  explicit Session(const LinkerSettings& settings) : linker(settings), tracks(linker.capacity()) {}

  /// Identities of the particles, in their order.
  std::vector<std::uint64_t> next(const Positions3& positions) { return next(positions, frame); }
  std::vector<std::uint64_t> next(const Positions3& positions, std::uint64_t at_frame) {
    return next(positions, at_frame, static_cast<std::int64_t>(at_frame) * kPeriodNs);
  }
  std::vector<std::uint64_t> next(const Positions3& positions, std::uint64_t at_frame, std::int64_t at_ns) {
    linker.next(particles_at(positions), at_frame, at_ns, tracks);
    frame = at_frame + 1;
    return tracks.particle;
  }

  Linker linker;
  Tracks tracks;
  std::uint64_t frame = 0;
};

inline double squared_distance(const Position& a, const Position& b) {
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) sum += (a[axis] - b[axis]) * (a[axis] - b[axis]);
  return sum;
}

/// Least Σ d² + range² per unlinked source over all ways to link, by trying them all.
inline double least_cost_by_trial(const Positions3& sources, const Positions3& targets, double range,
                                  std::size_t source = 0, std::uint64_t taken = 0) {
  if (source == sources.size()) return 0;
  double least = range * range + least_cost_by_trial(sources, targets, range, source + 1, taken);
  for (std::size_t t = 0; t < targets.size(); ++t) {
    const double cost = squared_distance(sources[source], targets[t]);
    if ((taken >> t & 1) != 0 || cost > range * range) continue;
    least =
        std::min(least, cost + least_cost_by_trial(sources, targets, range, source + 1, taken | std::uint64_t{1} << t));
  }
  return least;
}

/// The same sum for the links that a linker made. Identities of sources are 0, 1, … in order.
inline double cost_of_links(const Positions3& sources, const Positions3& targets,
                            const std::vector<std::uint64_t>& identities, double range) {
  double cost = range * range * static_cast<double>(sources.size());
  for (std::size_t t = 0; t < targets.size(); ++t)
    if (identities[t] < sources.size()) cost += squared_distance(sources[identities[t]], targets[t]) - range * range;
  return cost;
}

}  // namespace rptv
