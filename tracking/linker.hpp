// SPDX-License-Identifier: MIT
// Online Crocker–Grier linker: takes the particles of one frame at a time and continues, begins and ends tracks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/particles.hpp"
#include "core/tracks.hpp"
#include "tracking/flow_field.hpp"
#include "tracking/kalman.hpp"
#include "tracking/linker_counters.hpp"
#include "tracking/linker_settings.hpp"

namespace rptv {

/// Per frame it minimises Σ d² over links + search_range² per track left without one, d being the distance from a
/// track's (predicted) position to a particle and d ≤ search_range: Crocker & Grier, J. Colloid Interface Sci. 179
/// (1996) 298, solved exactly by a polynomial assignment per connected subnetwork, so that no subnetwork is too large.
/// With ranges per axis, d and the search range are in units of them. docs/linking.md has the rest.
///
/// - A track unseen for up to `memory` frame *indices* is still looked for; lost frames count as unseen.
/// - dt comes from `exposure_end_ns`. A clock that goes back, stands still or jumps (more than 1000 times the longest
///   step per frame so far) is counted: that step then counts as long as the one before, and velocities are kept.
/// - Velocity: (position − last position) / dt between the two frames in which the track was seen, mm/s; with a Kalman
///   filter the filtered one, and positions are the filtered ones too.
/// - Identities count up from 0 in the order of the particles and are never reused.
/// - A frame that passes `deadline_ms` is still answered: what is left is approximated, counted, and said in `out`.
///
/// The constructor takes all memory and throws Error(configuration) for settings out of range; next() and predict()
/// allocate nothing, never throw, and take bounded time for any input. One thread at a time.
class Linker {
 public:
  explicit Linker(const LinkerSettings& settings);
  ~Linker();
  Linker(Linker&&) noexcept;
  Linker& operator=(Linker&&) noexcept;

  /// Tells of the flow, before the first frame. Throws Error(configuration) when a value is not finite.
  void seed(std::span<const VelocitySample> samples);

  /// Clears `out` and fills it: one row per finite particle, in the particles' order; births in that order; deaths of
  /// tracks that can no longer be found again. Positions in the particles' frame of reference. Give `out` a capacity of
  /// capacity() so that nothing overflows. `frame` should increase; index gaps use up memory.
  void next(const Particles& particles, std::uint64_t frame, std::int64_t exposure_end_ns, Tracks& out) noexcept;

  /// Clears `out` and fills it with all live tracks, unseen ones included, as they are expected at a time on the
  /// exposures' clock, normally later than the last frame's. residual is 0. Nothing changes in the linker.
  void predict(std::int64_t exposure_ns, Tracks& out) const noexcept;

  /// The filter of row `row` of the last next(), at its exposure; null where predict is not a Kalman filter.
  const KalmanState* filter_of(std::size_t row) const noexcept;
  const KalmanModel& model() const noexcept;  ///< noise of the last frame

  /// Everything that the next frames depend on. restore() into a linker of equal settings goes on bit for bit; it
  /// throws Error(bad_data) for bytes that are not such a snapshot. Both allocate; between frames, not in them.
  std::vector<std::byte> snapshot() const;
  void restore(std::span<const std::byte> snapshot);

  const LinkerCounters& counters() const noexcept;
  std::size_t live_tracks() const noexcept;  ///< seen in the last frame or remembered
  std::size_t capacity() const noexcept;     ///< most tracks alive at once

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace rptv
