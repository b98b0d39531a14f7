// SPDX-License-Identifier: MIT
// Greedy explanation of the rays, and the exclusive refit that ends it.
#include "reconstruct/explain_away.hpp"

#include <algorithm>

#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {
constexpr double kClaimWider = 1.2;  // a particle also takes the crumbs just outside its gate, else they make ghosts
constexpr int kSettlePasses = 3;
constexpr std::size_t kFitBlock = 16;
}  // namespace

ExplainAway::ExplainAway(const RayWindow& window, const ExplainOptions& options)
    : window_(window),
      options_(options),
      fits_(options.threads, ParticleFit(window, options.fit, options.max_rays)),
      taken_(options.max_rays),
      tentative_(options.max_candidates),
      owner_(options.max_rays),
      owner_distance_(options.max_rays) {
  heap_.reserve(options.max_candidates);
  particles_.reserve(options.max_particles);
}

void ExplainAway::begin(const Rays& rays) noexcept {
  particles_.clear();
  refused_ = 0;
  std::fill_n(taken_.begin(), rays.pixels, std::uint8_t{0});
}

bool ExplainAway::acceptable(const FittedParticle& particle) const noexcept {
  return particle.support >= options_.fit.min_support && particle.at.z >= options_.lowest_z_mm &&
         particle.at.z <= options_.highest_z_mm;
}

void ExplainAway::fit_all(const Rays& rays, std::span<const Candidate> candidates) noexcept {
  const std::size_t blocks = (candidates.size() + kFitBlock - 1) / kFitBlock;
  parallel_for(blocks, options_.threads, [&](std::size_t block, std::size_t thread) {
    const std::size_t last = std::min((block + 1) * kFitBlock, candidates.size());
    for (std::size_t c = block * kFitBlock; c < last; ++c)
      tentative_[c] = fits_[thread].fit(rays, taken_, {candidates[c].x_mm, candidates[c].y_mm, candidates[c].z_mm});
  });
}

std::size_t ExplainAway::explain(const Rays& rays, std::span<const Candidate> candidates) noexcept {
  fit_all(rays, candidates);
  const auto weaker = [&](std::uint32_t a, std::uint32_t b) {
    return tentative_[a].support != tentative_[b].support ? tentative_[a].support < tentative_[b].support : a > b;
  };
  heap_.clear();
  for (std::uint32_t c = 0; c < candidates.size(); ++c)
    if (acceptable(tentative_[c])) heap_.push_back(c);
  std::make_heap(heap_.begin(), heap_.end(), weaker);
  std::size_t accepted = 0;
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end(), weaker);
    const std::uint32_t best = heap_.back();
    heap_.pop_back();
    auto& particle = tentative_[best];
    // Claims since it was fitted only ever take rays away: if its support stands, it is the strongest there is.
    const double support = options_.claim ? fits_[0].support_at(rays, taken_, particle.at) : particle.support;
    if (support >= particle.support) {
      accepted += accept(rays, particle);
      continue;
    }
    if (support < options_.fit.min_support) continue;
    particle = fits_[0].fit(rays, taken_, particle.at);
    if (!acceptable(particle)) continue;
    heap_.push_back(best);
    std::push_heap(heap_.begin(), heap_.end(), weaker);
  }
  return accepted;
}

bool ExplainAway::accept(const Rays& rays, const FittedParticle& particle) noexcept {
  if (!options_.claim && known(particle)) return false;
  if (particles_.size() == particles_.capacity()) {
    ++refused_;
    return false;
  }
  particles_.push_back(particle);
  if (options_.claim) claim(rays, particle);
  return true;
}

void ExplainAway::claim(const Rays& rays, const FittedParticle& particle) noexcept {
  const auto& gate = options_.fit.gate;
  const double reach_mm = kClaimWider * gate.half_width_at(particle.at.z);
  window_.visit(rays, particle.at, reach_mm, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      if (gate.distance(offset_of(rays.ray[i], particle.at)) <= reach_mm) taken_[rays.pixel[i]] = 1;
  });
}

bool ExplainAway::known(const FittedParticle& particle) const noexcept {
  return std::any_of(particles_.begin(), particles_.end(), [&](const FittedParticle& other) {
    return std::abs(other.at.x - particle.at.x) < options_.fit.start_margin_mm &&
           std::abs(other.at.y - particle.at.y) < options_.fit.start_margin_mm &&
           std::abs(other.at.z - particle.at.z) < options_.fit.start_depth_mm;
  });
}

void ExplainAway::assign(const Rays& rays) noexcept {
  std::fill_n(owner_.begin(), rays.pixels, -1);
  std::fill_n(owner_distance_.begin(), rays.pixels, 1.0F);
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    const auto& at = particles_[k].at;
    const double half_width_mm = options_.fit.gate.half_width_at(at.z);
    window_.visit(rays, at, half_width_mm, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const auto distance =
            static_cast<float>(options_.fit.gate.distance(offset_of(rays.ray[i], at)) / half_width_mm);
        if (distance >= owner_distance_[rays.pixel[i]]) continue;
        owner_distance_[rays.pixel[i]] = distance;
        owner_[rays.pixel[i]] = static_cast<std::int32_t>(k);
      }
    });
  }
}

void ExplainAway::fit_owned(const Rays& rays) noexcept {
  const std::size_t blocks = (particles_.size() + kFitBlock - 1) / kFitBlock;
  parallel_for(blocks, options_.threads, [&](std::size_t block, std::size_t thread) {
    const std::size_t last = std::min((block + 1) * kFitBlock, particles_.size());
    for (std::size_t k = block * kFitBlock; k < last; ++k)
      particles_[k] = fits_[thread].fit_owned(rays, owner_, static_cast<std::int32_t>(k), particles_[k].at);
  });
}

void ExplainAway::drop_weak() noexcept {
  std::erase_if(particles_, [&](const FittedParticle& particle) { return !acceptable(particle); });
}

void ExplainAway::settle(const Rays& rays) noexcept {
  for (int pass = 0; options_.claim && pass < kSettlePasses; ++pass) {
    assign(rays);
    fit_owned(rays);
    drop_weak();
  }
  std::sort(particles_.begin(), particles_.end(),
            [](const FittedParticle& a, const FittedParticle& b) { return a.support > b.support; });
}

}  // namespace rptv
