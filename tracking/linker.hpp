// SPDX-License-Identifier: MIT
// Online Crocker–Grier linker: takes the particles of one frame at a time and continues, begins and ends tracks.
#pragma once

#include <cstdint>
#include <memory>

#include "core/particles.hpp"
#include "core/tracks.hpp"
#include "tracking/linker_counters.hpp"
#include "tracking/linker_settings.hpp"

namespace rptv {

/// Per frame it minimises Σ d² over links + search_range² per track left without one, d being the distance from a
/// track's (predicted) position to a particle and d ≤ search_range: Crocker & Grier, J. Colloid Interface Sci. 179
/// (1996) 298, solved exactly by a polynomial assignment per connected subnetwork, so that no subnetwork is too large.
///
/// - A track unseen for up to `memory` frame *indices* is still looked for; lost frames count as unseen.
/// - dt comes from `exposure_end_ns`. A clock that goes back, stands still or jumps (more than 1000 times the longest
///   step per frame so far) is counted: that step then counts as long as the one before, and velocities are kept.
/// - Velocity: (position − last position) / dt between the two frames in which the track was seen, mm/s.
/// - Identities count up from 0 in the order of the particles and are never reused.
///
/// The constructor takes all memory and throws Error(configuration) for settings out of range; next() allocates
/// nothing, never throws, and takes bounded time for any input. One thread at a time.
class Linker {
 public:
  explicit Linker(const LinkerSettings& settings);
  ~Linker();
  Linker(Linker&&) noexcept;
  Linker& operator=(Linker&&) noexcept;

  /// Clears `out` and fills it: one row per finite particle, in the particles' order; births in that order; deaths of
  /// tracks that can no longer be found again. Positions in the particles' frame of reference. Give `out` a capacity of
  /// capacity() so that nothing overflows. `frame` should increase; index gaps use up memory.
  void next(const Particles& particles, std::uint64_t frame, std::int64_t exposure_end_ns, Tracks& out) noexcept;

  const LinkerCounters& counters() const noexcept;
  std::size_t live_tracks() const noexcept;  ///< seen in the last frame or remembered
  std::size_t capacity() const noexcept;     ///< most tracks alive at once

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace rptv
