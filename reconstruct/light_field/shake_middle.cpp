// SPDX-License-Identifier: MIT
// Two particles on the same rays are first taken for one between them; when both are found, the one between must go.
#include <array>
#include <cmath>

#include "reconstruct/light_field/shake.hpp"

namespace rptv {

namespace {
constexpr double kOnItsRays = 1.5;  // pitches aside, at most
constexpr std::size_t kMostAround = 4;
constexpr int kPasses = 3, kStepsAPass = 2;
}  // namespace

void Shake::paint_again(const FittedParticle& particle, double share, Worker& worker) noexcept {
  if (worker.model.render(particle.at, worker.now)) paint(worker.now, share * particle.light);
}

void Shake::drop_middles(std::span<FittedParticle> particles) noexcept {
  for (auto& p : particles) {
    std::array<FittedParticle*, kMostAround> around{};
    std::size_t count = 0;
    for (auto& q : particles) {
      if (&q == &p || !(q.light > 0) || count == kMostAround) continue;
      const ImagePoint on_ray = column_of_.slide(p.at, q.at.z);
      if (std::hypot(on_ray.x - q.at.x, on_ray.y - q.at.y) > kOnItsRays * options_.pitch_mm) continue;
      around[count++] = &q;
    }
    if (p.light > 0 && count > 1) explain_without(p, {around.data(), count});
  }
}

// Both ways are compared as wholes: one particle after the other is painted, and what each explains is added up.
bool Shake::explain_without(FittedParticle& middle, std::span<FittedParticle* const> around) noexcept {
  Worker& worker = workers_[0];
  paint_again(middle, -1, worker);
  for (const auto* q : around) paint_again(*q, -1, worker);
  double with = paint_and_weigh(middle, worker).gain;
  for (const auto* q : around) with += paint_and_weigh(*q, worker).gain;
  paint_again(middle, -1, worker);
  std::array<FittedParticle, kMostAround> alone;
  for (std::size_t k = 0; k < around.size(); ++k) alone[k] = *around[k];
  for (int pass = 0; pass < kPasses; ++pass)
    for (std::size_t k = 0; k < around.size(); ++k) {
      paint_again(alone[k], -1, worker);
      State state{alone[k], {}};
      if (render(state, worker.now, worker)) climb(state, worker, kStepsAPass);
      alone[k] = state.particle;
      paint_again(alone[k], 1, worker);
    }
  for (std::size_t k = 0; k < around.size(); ++k) paint_again(alone[k], -1, worker);
  double without = 0;
  for (std::size_t k = 0; k < around.size(); ++k) without += paint_and_weigh(alone[k], worker).gain;
  const bool dispensable = without > with - kLeastGain;
  if (dispensable) {
    middle.light = 0;
    for (std::size_t k = 0; k < around.size(); ++k) *around[k] = alone[k];
  } else {
    for (std::size_t k = 0; k < around.size(); ++k)
      paint_again(alone[k], -1, worker), paint_again(*around[k], 1, worker);
    paint_again(middle, 1, worker);
  }
  return dispensable;
}

}  // namespace rptv
