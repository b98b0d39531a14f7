// SPDX-License-Identifier: MIT
// How likely a fitted particle is a ghost, from what it explains and how.
#pragma once

#include "reconstruct/light_field/particle_fit.hpp"

namespace rptv {

/// What tells ghosts from particles. Most are two particles taken for one: too bright, with much left unexplained.
struct GhostEvidence {
  static constexpr int kCount = 4;
  double bright = 0;   ///< log of the light over that of the median particle
  double weak = 0;     ///< -log of the χ² explained
  double misfit = 0;   ///< 1 - agreement
  double crowded = 0;  ///< share of its light that falls where other particles' does
};

/// `median_light`: of the frame's particles. Only for particles fitted to the grey values.
GhostEvidence ghost_evidence(const FittedParticle& particle, double median_light) noexcept;

/// Logistic in the evidence; the factors are fitted by `rptv_bench_light_field ghosts` to simulated scenes, which also
/// prints how often what has this probability is one.
double ghost_probability(const GhostEvidence& evidence) noexcept;

/// The same for particles of the least-squares fit, from how many times the least support they have.
double ghost_probability_by_support(double times_least) noexcept;

}  // namespace rptv
