// SPDX-License-Identifier: MIT
// Near the array, the light of one particle in two lenslets looks like two particles: is one as good?
#include <algorithm>
#include <cmath>

#include "reconstruct/light_field/shake.hpp"

namespace rptv {

namespace {
constexpr double kNeighbours = 1.8;  // pitches apart, at most
constexpr int kStepsOfAJoin = 5;
constexpr double kSameDepth = 0.4;  // of the shallow depth
constexpr double kAsGood = 0.98;    // of the χ² that both explain: the simpler answer may explain a little less
}  // namespace

// Both near the array and in neighbouring lenslets; or anywhere on the same rays, one behind the other.
bool Shake::may_be_one(const FittedParticle& a, const FittedParticle& b) const noexcept {
  const double depth = std::abs(a.at.z - b.at.z);
  if (!(a.light > 0) || !(b.light > 0) || depth > 2 * options_.shallow_mm) return false;
  const ImagePoint on_ray = column_of_.slide(a.at, b.at.z);
  const double aside = std::max(std::abs(on_ray.x - b.at.x), std::abs(on_ray.y - b.at.y));
  if (std::max(std::abs(a.at.z), std::abs(b.at.z)) < options_.shallow_mm)
    return aside < kNeighbours * options_.pitch_mm;
  return depth < options_.shallow_mm && aside < options_.satellite_mm;
}

void Shake::join_halves(std::span<FittedParticle> particles) noexcept {
  for (std::size_t i = 0; i < particles.size(); ++i)
    for (std::size_t j = i + 1; j < particles.size(); ++j)
      if (may_be_one(particles[i], particles[j])) join(particles[i], particles[j], workers_[0]);
}

bool Shake::same_place(const FittedParticle& a, const FittedParticle& b) const noexcept {
  const ImagePoint on_ray = column_of_.slide(a.at, b.at.z);
  return a.light > 0 && b.light > 0 && std::abs(a.at.z - b.at.z) < kSameDepth * options_.shallow_mm &&
         std::max(std::abs(on_ray.x - b.at.x), std::abs(on_ray.y - b.at.y)) < options_.satellite_mm;
}

void Shake::join_twins(std::span<FittedParticle> particles) noexcept {
  for (std::size_t i = 0; i < particles.size(); ++i)
    for (std::size_t j = i + 1; j < particles.size(); ++j)
      if (same_place(particles[i], particles[j])) join(particles[i], particles[j], workers_[0]);
}

// Of a particle that is not painted; paints it. `worker` has its image.
ShakeSums Shake::paint_and_weigh(const FittedParticle& particle, Worker& worker) noexcept {
  State state{particle, {}};
  if (!render(state, worker.now, worker)) return {};
  paint(worker.now, particle.light);
  return state.sums;
}

bool Shake::join(FittedParticle& one, FittedParticle& other, Worker& worker) noexcept {
  for (const auto* p : {&one, &other})
    if (worker.model.render(p->at, worker.now)) paint(worker.now, -p->light);
  State whole{one, {}};
  const double share = one.light / (one.light + other.light);
  whole.particle.at = {share * one.at.x + (1 - share) * other.at.x, share * one.at.y + (1 - share) * other.at.y,
                       share * one.at.z + (1 - share) * other.at.z};
  whole.particle.light = 0;
  whole.particle.support = std::max(one.support, other.support);
  whole.sums.gain = -1;
  if (render(whole, worker.now, worker)) climb(whole, worker, kStepsOfAJoin);
  if (std::abs(whole.particle.at.z) < options_.shallow_mm) search_depth(whole, worker);
  const double first = paint_and_weigh(one, worker).gain;
  const ShakeSums last = paint_and_weigh(other, worker);
  const double apart = first + last.gain;
  const double chi_square = last.square / std::max(1.0, static_cast<double>(worker.now.size) - 4);
  if (misfit_ > 0 ? whole.sums.gain < kAsGood * apart
                  : whole.sums.gain < apart - kLeastGain * std::max(1.0, chi_square))
    return false;
  for (const auto* p : {&one, &other})
    if (worker.model.render(p->at, worker.now)) paint(worker.now, -p->light);
  one = whole.particle;
  other.light = 0;
  if (worker.model.render(one.at, worker.now)) paint(worker.now, one.light);
  return true;
}

}  // namespace rptv
