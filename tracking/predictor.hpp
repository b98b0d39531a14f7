// SPDX-License-Identifier: MIT
// Where to look for each track in the next frame, and how fast a track that was found has moved.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "tracking/frame_clock.hpp"
#include "tracking/track_state.hpp"

namespace rptv {

/// Expected positions, mm, one per track.
struct Positions {
  explicit Positions(std::size_t capacity) : x_mm(capacity), y_mm(capacity), z_mm(capacity) {}
  std::vector<double> x_mm, y_mm, z_mm;
};

/// "none": a track stays where it was seen last. "velocity": it goes on with its last velocity.
/// predict() and update(): one thread, no allocation.
class Predictor {
 public:
  /// Throws Error(configuration) for a name that it does not know.
  explicit Predictor(const std::string& name);

  /// Fills the first tracks.size() elements of `expected` with positions at `now`.
  void predict(std::span<const TrackState> tracks, const FrameTime& now, Positions& expected) const noexcept;

  /// Moves a track to where it was found at `now`. Velocity is the finite difference over the time since it was last
  /// seen; it is kept where no believable time lies between.
  static void update(TrackState& track, const FrameTime& now, double x_mm, double y_mm, double z_mm) noexcept {
    const std::int64_t dt_ns = now.ns - track.seen_ns;
    if (track.clock_epoch == now.epoch && dt_ns > 0) {
      const double per_s = 1e9 / static_cast<double>(dt_ns);
      track.vx_mm_s = (x_mm - track.x_mm) * per_s;
      track.vy_mm_s = (y_mm - track.y_mm) * per_s;
      track.vz_mm_s = (z_mm - track.z_mm) * per_s;
    }
    track.x_mm = x_mm;
    track.y_mm = y_mm;
    track.z_mm = z_mm;
    track.seen_ns = now.ns;
    track.seen_frame = now.frame;
    track.clock_epoch = now.epoch;
    ++track.age_frames;
  }

 private:
  bool carry_velocity_;
};

}  // namespace rptv
