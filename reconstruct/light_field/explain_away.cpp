// SPDX-License-Identifier: MIT
// Greedy explanation of the rays, and the exclusive refit that ends it.
#include "reconstruct/light_field/explain_away.hpp"

#include <algorithm>

#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {
constexpr std::size_t kFitBlock = 16;
}  // namespace

ExplainAway::ExplainAway(const RayWindow& window, const ExplainOptions& options)
    : options_(options),
      search_(window, options.max_rays),
      fits_(options.threads, ParticleFit(window, options.fit, options.max_rays)),
      taken_(options.max_rays),
      near_(2 * options.max_rays),
      owner_(options.max_rays),
      owner_distance_(options.max_rays) {
  tentative_.reserve(options.max_candidates);
  particles_.reserve(options.max_particles);
  near_end_.reserve(options.max_particles);
}

void ExplainAway::begin(const Rays& rays) noexcept {
  particles_.clear();
  refused_ = 0;
  std::fill_n(taken_.begin(), rays.size, std::uint8_t{0});
}

void ExplainAway::queue_up(std::span<const Candidate> candidates) noexcept {
  tentative_.clear();
  for (const auto& candidate : candidates) {
    if (tentative_.size() == tentative_.capacity()) break;
    Tentative next;
    next.particle.at = {candidate.x_mm, candidate.y_mm, candidate.z_mm};
    next.particle.support = candidate.rays;
    next.number = static_cast<std::uint32_t>(tentative_.size());
    tentative_.push_back(next);
  }
  std::make_heap(tentative_.begin(), tentative_.end());
}

// Fits again where claims have taken rays since the last fit; false when nothing is left to find here.
bool ExplainAway::improve(const Rays& rays, Tentative& candidate) noexcept {
  // Claims are settled in the end, by fits of their own.
  candidate.particle =
      fits_[0].fit(rays, taken_, candidate.particle.at, options_.claim ? FitFor::place : FitFor::result);
  candidate.fitted = true;
  return acceptable(candidate.particle);
}

std::size_t ExplainAway::explain(const Rays& rays, std::span<const Candidate> candidates) noexcept {
  queue_up(candidates);
  std::size_t accepted = 0;
  while (!tentative_.empty()) {
    std::pop_heap(tentative_.begin(), tentative_.end());
    auto& best = tentative_.back();
    // Claims only ever take rays away: if its support still stands, it is the strongest there is.
    if (best.fitted &&
        (!options_.claim || fits_[0].support_at(rays, taken_, best.particle.at) >= best.particle.support)) {
      accepted += accept(rays, best.particle);
      tentative_.pop_back();
    } else if (improve(rays, best)) {
      std::push_heap(tentative_.begin(), tentative_.end());
    } else {
      tentative_.pop_back();
    }
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
  for (const std::uint32_t i : search_.find(rays, gate, particle.at, reach_mm)) {
    for (std::uint32_t same = i; taken_[same] == 0; same = rays.same_pixel[same]) taken_[same] = 1;
  }
}

bool ExplainAway::known(const FittedParticle& particle) const noexcept {
  return std::any_of(particles_.begin(), particles_.end(), [&](const FittedParticle& other) {
    return std::abs(other.at.x - particle.at.x) < options_.fit.start_margin_mm &&
           std::abs(other.at.y - particle.at.y) < options_.fit.start_margin_mm &&
           std::abs(other.at.z - particle.at.z) < options_.fit.start_depth_mm;
  });
}

// Keeps the rays that it finds near each particle, as far as there is room, for fit_owned().
void ExplainAway::assign(const Rays& rays) noexcept {
  std::fill_n(owner_.begin(), rays.pixels, -1);
  near_end_.clear();
  std::fill_n(owner_distance_.begin(), rays.pixels, 1.0F);
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    const auto& at = particles_[k].at;
    const double half_width_mm = options_.fit.gate.half_width_at(at.z);
    const auto per_half_width = static_cast<float>(1 / half_width_mm);
    const auto near = search_.find(rays, options_.fit.gate, at, half_width_mm);
    const std::size_t begin = near_end_.empty() ? 0 : near_end_.back();
    if (near_end_.size() == k && near.size() <= near_.size() - begin) {
      std::copy(near.begin(), near.end(), near_.begin() + static_cast<std::ptrdiff_t>(begin));
      near_end_.push_back(begin + near.size());
    }
    for (std::size_t i = 0; i < near.size(); ++i) {
      const std::uint32_t pixel = rays.pixel[near[i]];
      const float distance = search_.distances_mm()[i] * per_half_width;
      if (distance >= owner_distance_[pixel]) continue;
      owner_distance_[pixel] = distance;
      owner_[pixel] = static_cast<std::int32_t>(k);
    }
  }
}

void ExplainAway::fit_owned(const Rays& rays, FitFor purpose) noexcept {
  const std::size_t blocks = (particles_.size() + kFitBlock - 1) / kFitBlock;
  parallel_for(blocks, options_.threads, [&](std::size_t block, std::size_t thread) {
    const std::size_t last = std::min((block + 1) * kFitBlock, particles_.size());
    for (std::size_t k = block * kFitBlock; k < last; ++k) {
      const ImagePoint at = particles_[k].at;
      const auto near = k < near_end_.size() ? near_of(k) : fits_[thread].find_near(rays, at);
      particles_[k] = fits_[thread].fit_owned(rays, near, owner_, static_cast<std::int32_t>(k), at, purpose);
    }
  });
}

void ExplainAway::drop_weak() noexcept {
  std::erase_if(particles_, [&](const FittedParticle& particle) { return !acceptable(particle); });
}

void ExplainAway::settle(const Rays& rays) noexcept {
  for (int pass = 0; options_.claim && pass < kSettlePasses; ++pass) {
    assign(rays);
    fit_owned(rays, pass + 1 < kSettlePasses ? FitFor::place : FitFor::result);
    drop_weak();
  }
  std::sort(particles_.begin(), particles_.end(), by_support);
}

}  // namespace rptv
