// SPDX-License-Identifier: MIT
// Predictions of the two kinds: standing still and constant velocity.
#include "tracking/predictor.hpp"

#include "core/error.hpp"

namespace rptv {

Predictor::Predictor(const std::string& name) : carry_velocity_(name == "velocity") {
  if (name != "velocity" && name != "none")
    throw Error(ExitCode::configuration, "predict '" + name + "' is not known; use 'none' or 'velocity'");
}

void Predictor::predict(std::span<const TrackState> tracks, const FrameTime& now, Positions& expected) const noexcept {
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const TrackState& track = tracks[i];
    const double dt_s = carry_velocity_ ? static_cast<double>(now.ns - track.seen_ns) * 1e-9 : 0.0;
    expected.x_mm[i] = track.x_mm + track.vx_mm_s * dt_s;
    expected.y_mm[i] = track.y_mm + track.vy_mm_s * dt_s;
    expected.z_mm[i] = track.z_mm + track.vz_mm_s * dt_s;
  }
}

}  // namespace rptv
