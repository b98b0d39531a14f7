// SPDX-License-Identifier: MIT
// Two logistic functions and their factors.
#include "reconstruct/light_field/ghost_probability.hpp"

#include <algorithm>
#include <cmath>

namespace rptv {

namespace {
constexpr double kFaintest = 1e-3;
constexpr double kAt0 = -1.67, kBright = 4.50, kWeak = 0.180, kMisfit = 8.79, kCrowded = -0.856;
constexpr double kSupportAt1 = 0.0928, kPerLogSupport = -0.614;

double logistic(double t) noexcept { return 1 / (1 + std::exp(-t)); }
}  // namespace

GhostEvidence ghost_evidence(const FittedParticle& particle, double median_light) noexcept {
  return {std::log(std::max(particle.light / std::max(median_light, kFaintest), kFaintest)),
          -std::log(std::max(particle.gain, 1.0)), 1 - particle.agreement, particle.crowded};
}

double ghost_probability(const GhostEvidence& e) noexcept {
  return logistic(kAt0 + kBright * e.bright + kWeak * e.weak + kMisfit * e.misfit + kCrowded * e.crowded);
}

double ghost_probability_by_support(double times_least) noexcept {
  return logistic(kSupportAt1 + kPerLogSupport * std::log(std::max(times_least, kFaintest)));
}

}  // namespace rptv
