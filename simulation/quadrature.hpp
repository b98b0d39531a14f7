// SPDX-License-Identifier: MIT
// Even coverings of pupil and particle, so that few rays stand for all.
#pragma once

#include <vector>

#include "simulation/main_lens.hpp"

namespace rptv {

/// Pairs of points in two discs, pupil and particle, evenly over the four dimensions (low-discrepancy sequence R4:
/// Roberts 2018). A first part of the sequence is even as well.
std::vector<RaySample> particle_samples(std::size_t count);

/// The pupil covered as evenly as can be (sunflower spiral, Vogel 1979), with any even covering of the other disc.
std::vector<RaySample> lenslet_samples(std::size_t count);

}  // namespace rptv
