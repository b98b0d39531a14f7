// SPDX-License-Identifier: MIT
// The order of the work: stripes, sweeps, one particle at a time, ghosts.
#include "reconstruct/light_field/shake.hpp"

#include <algorithm>
#include <cmath>

#include "reconstruct/light_field/shake_step.hpp"
#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {

constexpr std::size_t kBlockPixels = 64;
constexpr int kStepsAVisit = 2, kStepsOfASearch = 3;
constexpr double kStillGain = 0.05;  // a step that promises to explain less χ² than this is not worth an image
constexpr float kMisfit = 0.1F;      // of the model of a particle's image: none is made of another's errors
}  // namespace

Shake::Shake(const LightFieldCalibration& calibration, const LensletLattice& lattice, const ShakeOptions& options)
    : options_(options),
      width_px_(static_cast<std::uint32_t>(calibration.sensor.width_px)),
      column_of_(calibration),
      explained_(static_cast<std::size_t>(calibration.sensor.width_px * calibration.sensor.height_px)),
      painted_(explained_.size() / kBlockPixels + 1),
      workers_(options.threads, Worker(ImageModel(calibration, lattice, options.model),
                                       LensletMisfit(calibration, lattice), options.max_pixels)) {
  const double reach =
      workers_[0].model.reach_px(std::max(std::abs(options.lowest_z_mm), std::abs(options.highest_z_mm)));
  stripe_px_ = 2 * reach + static_cast<double>(kBlockPixels);
  stripes_ = std::max<std::size_t>(1, static_cast<std::size_t>(static_cast<double>(width_px_) / stripe_px_));
  stripe_first_.resize(stripes_ + 1);
  order_.resize(options.max_particles);
  lights_.reserve(options.max_particles);
}

void Shake::begin(const ImageView& image, std::span<const float> background) noexcept {
  image_ = image;
  misfit_ = kMisfit;
  background_ = background;
  for (std::size_t block = 0; block < painted_.size(); ++block) {
    if (painted_[block] == 0) continue;
    painted_[block] = 0;
    const std::size_t first = block * kBlockPixels;
    std::fill_n(explained_.begin() + static_cast<std::ptrdiff_t>(first),
                std::min(kBlockPixels, explained_.size() - first), 0.0F);
  }
}

Seen Shake::look(const ParticleImage& image, Worker& worker) const noexcept {
  for (std::size_t i = 0; i < image.size; ++i) {
    worker.others[i] = explained_[image.pixel[i]];
    worker.grey[i] = grey(image.pixel[i]) - worker.others[i];
  }
  return {worker.grey.data(), worker.others.data(),
          static_cast<float>(options_.dark_noise_grey * options_.dark_noise_grey + 1.0 / 12),
          static_cast<float>(1 / options_.electrons_per_grey), misfit_};
}

void Shake::paint(const ParticleImage& image, double light) noexcept {
  const auto l = static_cast<float>(light);
  for (std::size_t i = 0; i < image.size; ++i) {
    explained_[image.pixel[i]] += l * image.value[i];
    painted_[image.pixel[i] / kBlockPixels] = 1;
  }
}

// Counting sort by stripe, in the given order within a stripe.
void Shake::sort_into_stripes(std::span<const FittedParticle> particles) noexcept {
  const auto stripe_of = [&](const FittedParticle& p) {
    const double stripe = std::clamp(column_of_(p.at) / stripe_px_, 0.0, static_cast<double>(stripes_) - 1);
    return static_cast<std::size_t>(stripe);
  };
  std::fill(stripe_first_.begin(), stripe_first_.end(), 0U);
  for (const auto& p : particles) ++stripe_first_[stripe_of(p) + 1];
  for (std::size_t s = 1; s <= stripes_; ++s) stripe_first_[s] += stripe_first_[s - 1];
  for (std::size_t i = particles.size(); i-- > 0;)
    order_[--stripe_first_[stripe_of(particles[i]) + 1]] = static_cast<std::uint32_t>(i);
  // first[s + 1] is now the start of stripe s.
  std::copy(stripe_first_.begin() + 1, stripe_first_.end(), stripe_first_.begin());
  stripe_first_.back() = static_cast<std::uint32_t>(particles.size());
}

// Even stripes side by side, then odd ones: the images of two that are worked on at a time never meet.
void Shake::for_each(std::span<FittedParticle> particles, const auto& visit) noexcept {
  for (std::size_t parity = 0; parity < 2; ++parity)
    parallel_for((stripes_ + 1 - parity) / 2, options_.threads, [&](std::size_t item, std::size_t thread) {
      const std::size_t stripe = 2 * item + parity;
      for (std::size_t k = stripe_first_[stripe]; k < stripe_first_[stripe + 1]; ++k)
        visit(particles[order_[k]], workers_[thread], order_[k]);
    });
}

std::size_t Shake::refine(std::span<FittedParticle> particles, std::size_t first_new) noexcept {
  sort_into_stripes(particles);
  for_each(particles, [&](FittedParticle& p, Worker& worker, std::size_t number) {
    if (number >= first_new) introduce(p, worker);
  });
  for (std::int64_t sweep = 0; sweep < options_.sweeps; ++sweep) {
    for_each(particles, [&](FittedParticle& p, Worker& worker, std::size_t number) {
      if (number < first_new && sweep + 1 < options_.sweeps) return;  // they were settled before
      fit(p, worker, sweep == 0 && number >= first_new);
    });
    if (sweep == 0 || sweep + 2 == options_.sweeps) join_halves(particles);
    if (sweep + 2 == options_.sweeps) {  // neighbours have the last sweep to recover
      if (first_new > 0) drop_middles(particles);
      mark_ghosts(particles);
    }
  }
  mark_ghosts(particles);
  return drop_ghosts(particles);
}

void Shake::paint_all(std::span<FittedParticle> particles) noexcept {
  sort_into_stripes(particles);
  for_each(particles, [&](FittedParticle& p, Worker& worker, std::size_t) {
    if (worker.model.render(p.at, worker.now))
      paint(worker.now, p.light);
    else
      p.light = 0;
  });
}

std::size_t Shake::unite(std::span<FittedParticle> particles) noexcept {
  paint_all(particles);
  misfit_ = 0;
  join_twins(particles);
  misfit_ = kMisfit;
  return drop_ghosts(particles);
}

std::size_t Shake::describe(std::span<FittedParticle> particles) noexcept {
  paint_all(particles);
  for_each(particles, [&](FittedParticle& p, Worker& worker, std::size_t) {
    if (!(p.light > 0) || !worker.model.render(p.at, worker.now)) return;
    paint(worker.now, -p.light);
    State state{p, {}};
    weigh(state, worker.now, worker);
    tell(state, worker, p);
    p.residual_mm = std::sqrt(p.covariance.xx + p.covariance.yy);
    p.support = static_cast<double>(
        std::count_if(worker.now.value.begin(), worker.now.value.begin() + static_cast<std::ptrdiff_t>(worker.now.size),
                      [&](float value) { return p.light * static_cast<double>(value) > options_.lit_grey; }));
    paint(worker.now, p.light);
  });
  mark_ghosts(particles);
  return drop_ghosts(particles);
}

// Its light from what is left of the image where it is.
void Shake::introduce(FittedParticle& particle, Worker& worker) noexcept {
  particle.light = 0;
  if (!worker.model.render(particle.at, worker.now)) return;
  const BestLight best = best_light(worker.now, look(worker.now, worker));
  particle.light = std::max(best.light, 0.0);
  paint(worker.now, particle.light);
}

bool Shake::render(State& state, ParticleImage& image, Worker& worker) const noexcept {
  if (!worker.model.render(state.particle.at, image)) return false;
  weigh(state, image, worker);
  return true;
}

void Shake::weigh(State& state, const ParticleImage& image, Worker& worker) const noexcept {
  const Seen seen = look(image, worker);
  if (!(state.particle.light > 0)) state.particle.light = std::max(best_light(image, seen).light, 1e-3);
  state.sums = sum_up(image, seen, state.particle.light);
}

void Shake::fit(FittedParticle& particle, Worker& worker, bool search) noexcept {
  if (!(particle.light > 0) || !worker.model.render(particle.at, worker.now)) return;
  paint(worker.now, -particle.light);
  State state{particle, {}};
  weigh(state, worker.now, worker);
  climb(state, worker, kStepsAVisit);
  if (search && std::abs(particle.at.z) < options_.shallow_mm) search_depth(state, worker);
  particle = state.particle;
  tell(state, worker, particle);
  paint(worker.now, particle.light);
}

// Levenberg-Marquardt; `worker.now` is the image of the state before and after.
void Shake::climb(State& state, Worker& worker, int steps) const noexcept {
  double damping = 1e-3;
  for (int tries = 0, done = 0; done < steps && tries < 2 * steps; ++tries) {
    State next = state;
    if (!(take_step(state.sums, damping, next.particle) > kStillGain)) return;
    if (next.particle.light > 0 && render(next, worker.next, worker) && next.sums.gain >= state.sums.gain) {
      state = next;
      std::swap(worker.now, worker.next);
      damping *= 0.2;
      ++done;
    } else {
      damping = std::max(damping * 20, 1e-2);
    }
  }
}

// Near the array few lenslets see a particle, and several depths may look alike: try some, keep the one that explains
// most.
void Shake::search_depth(State& state, Worker& worker) const noexcept {
  const State first = state;
  for (const double share : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    State other = first;
    other.particle.at = column_of_.slide(first.particle.at, share * options_.shallow_mm);
    other.particle.light = 0;
    if (!render(other, worker.now, worker)) continue;
    climb(other, worker, kStepsOfASearch);
    if (other.sums.gain > state.sums.gain) state = other;
  }
  worker.model.render(state.particle.at, worker.now);
}

}  // namespace rptv
