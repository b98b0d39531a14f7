// SPDX-License-Identifier: MIT
// What is known about a fitted particle: what it explains, and how sure its place is.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "reconstruct/light_field/shake.hpp"

namespace rptv {

namespace {

// What no noise model knows: how well the model's borders between lenslets lie where the real ones are, in pitches.
// Read off scenes traced without noise. Near the array few pixels of few lenslets show the depth, and what counts is
// the particle's shape in them; far from it the many narrow pieces are blurred more than the model has it.
constexpr double kBorderErrorNear = 1.7, kNear = 0.3;  // over squared pixels of a sub-image; in shallow depths
constexpr double kBorderErrorFar = 0.0007;             // per squared shallow depth

double border_error_mm(const ShakeOptions& options, double z_mm) noexcept {
  const double depth = std::abs(z_mm) / options.shallow_mm;
  const double near = kBorderErrorNear / (options.subimage_px * options.subimage_px);
  return options.pitch_mm * (near / (1 + std::pow(depth / kNear, 2)) + kBorderErrorFar * depth * depth);
}

}  // namespace

// What is known about a particle that is not painted; `worker` has its image.
void Shake::tell(const State& state, Worker& worker, FittedParticle& particle) const noexcept {
  const ParticleImage& image = worker.now;
  particle.chi_square = state.sums.square / std::max(1.0, static_cast<double>(image.size) - 4);
  particle.gain = state.sums.gain;
  const auto pixels = static_cast<double>(image.size);  // noise leaves χ² pixels ± √(2·pixels)
  const double left = state.sums.square - pixels - 3 * std::sqrt(2 * pixels);
  particle.agreement = state.sums.gain > 0 ? state.sums.gain / (state.sums.gain + std::max(left, 0.0)) : 0;
  particle.crowded = crowded(state, worker);
  particle.seen =
      std::accumulate(image.value.begin(), image.value.begin() + static_cast<std::ptrdiff_t>(image.size), 0.0);
  const double border_mm = border_error_mm(options_, particle.at.z);
  const double misfit =
      std::max({1.0, particle.chi_square, worker.disagreement(image, look(image, worker), particle.light)});
  particle.misfit = misfit;
  particle.covariance =
      covariance_of(state.sums, misfit, border_mm, options_.slope_rms, column_of_.direction(particle.at));
  auto& c = particle.covariance;
  const auto& shared = particle.shared;
  c = {c.xx + misfit * shared.xx, c.xy + misfit * shared.xy, c.xz + misfit * shared.xz,
       c.yy + misfit * shared.yy, c.yz + misfit * shared.yz, c.zz + misfit * shared.zz};
}

}  // namespace rptv
