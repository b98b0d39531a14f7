// SPDX-License-Identifier: MIT
// Which fitted particles are none.
#include <algorithm>
#include <cmath>

#include "reconstruct/light_field/ghost_probability.hpp"
#include "reconstruct/light_field/shake.hpp"

namespace rptv {

namespace {
constexpr double kSatelliteShare = 0.35, kSamePlace = 0.2;
constexpr double kLeastSeen = 0.3;  // of its light, on the sensor
}  // namespace

// `worker` has the image of the state and the light of the others.
double Shake::crowded(const State& state, const Worker& worker) const noexcept {
  const ParticleImage& image = worker.now;
  double all = 0, shared = 0;
  for (std::size_t i = 0; i < image.size; ++i) {
    const double others = std::max(static_cast<double>(explained_[image.pixel[i]]), 0.0);
    const auto value = static_cast<double>(image.value[i]);
    all += value;
    shared += value * others / std::max(others + state.particle.light * value, 1e-9);
  }
  return all > 0 ? shared / all : 0;
}

// The same particle twice; or much weaker than a neighbour on the same rays: light of that one which the model puts
// elsewhere.
bool Shake::is_satellite(const FittedParticle& weak, const FittedParticle& strong) const noexcept {
  const double depth = std::abs(weak.at.z - strong.at.z);
  if (!(weak.light < strong.light) || depth > options_.shallow_mm) return false;
  if (weak.light > kSatelliteShare * strong.light && depth > kSamePlace * options_.shallow_mm) return false;
  const ImagePoint on_ray = column_of_.slide(strong.at, weak.at.z);
  return std::abs(on_ray.x - weak.at.x) < options_.satellite_mm &&
         std::abs(on_ray.y - weak.at.y) < options_.satellite_mm;
}

// Light 0 marks a ghost.
void Shake::mark_ghosts(std::span<FittedParticle> particles) noexcept {
  lights_.clear();
  for (const auto& p : particles)
    if (p.light > 0) lights_.push_back(static_cast<float>(p.light));
  if (lights_.empty()) return;
  const auto middle = lights_.begin() + static_cast<std::ptrdiff_t>(lights_.size() / 2);
  std::nth_element(lights_.begin(), middle, lights_.end());
  const double least = options_.least_share * static_cast<double>(*middle);
  Worker& worker = workers_[0];
  for (auto& p : particles) {
    p.ghost = ghost_probability(ghost_evidence(p, static_cast<double>(*middle)));
    const bool inside = p.at.z >= options_.lowest_z_mm && p.at.z <= options_.highest_z_mm;
    const bool real =
        inside && p.light * p.agreement >= least && p.gain >= kLeastGain && p.seen >= kLeastSeen &&
        std::none_of(particles.begin(), particles.end(), [&](const auto& q) { return is_satellite(p, q); });
    if (!(p.light > 0) || real) continue;
    if (worker.model.render(p.at, worker.now)) paint(worker.now, -p.light);
    p.light = 0;
  }
}

std::size_t Shake::drop_ghosts(std::span<FittedParticle> particles) noexcept {
  const auto end = std::remove_if(particles.begin(), particles.end(), [](const auto& p) { return !(p.light > 0); });
  return static_cast<std::size_t>(end - particles.begin());
}

}  // namespace rptv
