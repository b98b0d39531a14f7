// SPDX-License-Identifier: MIT
// What of a filter's state is given out.
#pragma once

#include "core/tracks.hpp"
#include "tracking/kalman.hpp"

namespace rptv {

inline TrackEstimate estimate_of(const KalmanState& state) noexcept {
  TrackEstimate out;
  out.ax_mm_s2 = state.x[2][0];
  out.ay_mm_s2 = state.x[2][1];
  out.az_mm_s2 = state.x[2][2];
  out.position_mm2 = upper(state.p[KalmanState::block(0, 0)]);
  out.velocity_mm2_s2 = upper(state.p[KalmanState::block(1, 1)]);
  out.acceleration_mm2_s4 = upper(state.p[KalmanState::block(2, 2)]);
  return out;
}

}  // namespace rptv
