// SPDX-License-Identifier: MIT
// How each track swings with a wall: the amplitude and phase of its harmonic, and what they weigh.
#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "simulation/wall_profile.hpp"

namespace rptv {

/// The swing of one track: amplitude·exp(i phase) of sin, at its mean height above the wall.
struct Swing {
  double height_mm = 0;
  std::complex<double> value;
  double weight = 0;  ///< inverse variance of one component, 1/mm²; first for unit noise
  double square_sum = 0;
  std::uint64_t points = 0, terms = 0;
};

/// Of all tracks that are long enough, weighed by their noise. Throws Error(bad_data) when there is none. Batch.
std::vector<Swing> swings_of(const std::vector<TrackRow>& rows, const FlowSettings& flow,
                             const WallProfileSettings& settings);

}  // namespace rptv
