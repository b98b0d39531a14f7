// SPDX-License-Identifier: MIT
// The order of the rounds, and how bright a particle is.
#include "reconstruct/light_field/dense_search.hpp"

#include <algorithm>
#include <cmath>

#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {

constexpr std::int32_t kPlaces = 6;  // tried in a cell, along each axis
constexpr float kFirstScore = 0.85F, kLastScore = 0.25F, kScoreStep = 0.05F;
constexpr int kMostLastRounds = 4;
constexpr double kExcessSigmas = 0.25;
constexpr int kSteps = 4, kFinalSteps = 15;
constexpr double kWeak = 0.5;  // of the typical light: looked for last
constexpr float kFirstWeakScore = 0.5F;
constexpr double kLeastLight = 0.2;  // of the typical light, until the end
constexpr double kMostLight = 1e30;  // of a particle, in the end
constexpr double kPair = 1.4;        // of the typical light
constexpr double kSplitPitches = 0.1;
constexpr double kWorthMoving = 1;  // χ²
constexpr int kPlaceRounds = 2;
constexpr double kFaintSigmas = 2;  // of a dark pixel
constexpr std::size_t kHitsAParticle = 64;
// A particle is as bright as the darker ones of its pixels say, which it need not share; the typical one is the median.
constexpr float kBright = 0.3F;  // of a particle's brightest pixel: enough to tell its light
constexpr double kAlone = 0.1, kTypical = 0.5;

FootprintGrid grid_of(const ShakeOptions& options) {
  FootprintGrid grid;
  grid.places = kPlaces;
  grid.lowest_z_mm = options.lowest_z_mm, grid.highest_z_mm = options.highest_z_mm;
  // The outermost ray, of twice the rms slope, moves as far as from one place to the next.
  grid.depth_step_mm = options.pitch_mm / kPlaces / (2 * options.slope_rms);
  return grid;
}

double dark_variance(const ShakeOptions& options) noexcept {
  return options.dark_noise_grey * options.dark_noise_grey + 1.0 / 12;
}

float quantile(std::span<float> values, double share) noexcept {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

DenseSearch::DenseSearch(const LightFieldCalibration& calibration, const LensletLattice& lattice,
                         const ShakeOptions& options)
    : options_(options),
      footprints_(calibration, lattice, options.model, grid_of(options)),
      search_(footprints_, lattice,
              {static_cast<std::uint32_t>(calibration.sensor.width_px),
               static_cast<std::uint32_t>(calibration.sensor.height_px), 2},
              kHitsAParticle * options.max_particles, options.threads),
      fit_(calibration, lattice,
           make_joint_fit_options(options, 2 * footprints_.most_pixels(), footprints_.mean_pixels())),
      model_(calibration, lattice, options.model),
      image_(2 * footprints_.most_pixels()) {
  grey_.resize(static_cast<std::size_t>(calibration.sensor.width_px * calibration.sensor.height_px));
  residual_.resize(grey_.size());
  other_places_.reserve(options.threads);
  for (std::size_t k = 0; k < options.threads; ++k)  // not copies, which would have no room kept
    other_places_.emplace_back(calibration, lattice, options, 2 * footprints_.most_pixels());
  ratios_.reserve(2 * footprints_.most_pixels());
  lights_.reserve(options.max_particles);
  particles_.reserve(options.max_particles);
  before_.reserve(options.max_particles);
  spreads_.resize(options.max_particles);
}

void DenseSearch::begin(const ImageView& image, std::span<const float> background) noexcept {
  grey_above(image, background, grey_);
  fit_.begin(grey_);
  particles_.clear();
  refused_ = refused_hits_ = 0;
}

double DenseSearch::typical_light(std::span<const FittedParticle> near) noexcept {
  lights_.clear();
  for (const auto& p : near) {
    if (lights_.size() == lights_.capacity() || !model_.render(p.at, image_)) continue;
    const auto end = image_.value.begin() + static_cast<std::ptrdiff_t>(image_.size);
    const float bright = kBright * *std::max_element(image_.value.begin(), end);
    ratios_.clear();
    for (std::size_t i = 0; i < image_.size; ++i)
      if (image_.value[i] > bright) ratios_.push_back(grey_[image_.pixel[i]] / image_.value[i]);
    lights_.push_back(quantile(ratios_, kAlone));
  }
  return lights_.empty() ? 0 : static_cast<double>(quantile(lights_, kTypical));
}

std::size_t DenseSearch::add_hits(double light, float least_score) noexcept {
  const auto explained = fit_.explained();
  for (std::size_t i = 0; i < residual_.size(); ++i) residual_[i] = grey_[i] - explained[i];
  footprints_.set_light(light, dark_variance(options_), 1 / options_.electrons_per_grey);
  const auto faint = static_cast<float>(kFaintSigmas * std::sqrt(dark_variance(options_)));
  const std::size_t known = particles_.size();
  for (const auto& hit : search_.find(residual_, least_score, faint)) {
    if (search_.score(residual_, hit) < least_score) continue;  // another has taken its light
    if (particles_.size() == particles_.capacity()) {
      ++refused_;
      continue;
    }
    particles_.push_back({footprints_.at(hit.footprint, hit.lenslet), light});
    search_.subtract(residual_, hit);
  }
  refused_hits_ += search_.refused();
  return particles_.size() - known;
}

void DenseSearch::drop_weak(double least_light) noexcept {
  std::erase_if(particles_, [&](const JointParticle& p) {
    refused_ += p.light > 0 ? 0 : 1;  // no room for its image
    return !(p.light >= least_light) || p.at.z < options_.lowest_z_mm || p.at.z > options_.highest_z_mm;
  });
}

// The median can only fall: it starts too bright where images overlap.
void DenseSearch::follow_light() noexcept {
  if (particles_.empty()) return;
  lights_.clear();
  for (const auto& p : particles_) lights_.push_back(static_cast<float>(p.light));
  light_ = static_cast<double>(quantile(lights_, kTypical));
}

// For particles of `share` of the typical light.
void DenseSearch::search(double share, float first_score, bool capped) noexcept {
  float least_score = first_score;
  for (int last_rounds = 0; last_rounds < kMostLastRounds;) {
    const std::size_t added = add_hits(share * light_, least_score);
    if (added > 0) {
      fit_.fit(particles_, {kSteps, capped ? light_ : kMostLight, kExcessSigmas});
      drop_weak(kLeastLight * light_);
      if (capped) follow_light();
    }
    if (least_score <= kLastScore) last_rounds = added > 0 ? last_rounds + 1 : kMostLastRounds;
    least_score = std::max(least_score - kScoreStep, kLastScore);
  }
}

// Each for itself, then all together; what is no better is undone.
bool DenseSearch::try_other_places() noexcept {
  before_ = particles_;
  const JointView view{grey_, fit_.explained()};
  parallel_for(particles_.size(), options_.threads, [&](std::size_t k, std::size_t thread) {
    FittedParticle particle;
    particle.at = particles_[k].at, particle.light = particles_[k].light;
    if (other_places_[thread].improve(particle, view) > kWorthMoving) particles_[k] = {particle.at, particle.light};
  });
  const double misfit = fit_.fit(particles_, {kFinalSteps, kMostLight, 0});
  const bool better = misfit < misfit_ - kWorthMoving;
  if (better)
    misfit_ = misfit;
  else
    particles_ = before_, misfit_ = fit_.fit(particles_, {kFinalSteps, kMostLight, 0});
  return better;
}

void DenseSearch::widen_where_ambiguous() noexcept {
  const JointView view{grey_, fit_.explained()};
  parallel_for(particles_.size(), options_.threads, [&](std::size_t k, std::size_t thread) {
    FittedParticle particle;
    particle.at = particles_[k].at, particle.light = particles_[k].light;
    const FitCovariance more = other_places_[thread].ambiguity(particle, view);
    auto& c = spreads_[k].shared;
    c = {c.xx + more.xx, c.xy + more.xy, c.xz + more.xz, c.yy + more.yy, c.yz + more.yz, c.zz + more.zz};
  });
}

// Two that are one so far; when they turn out to be one, they are made one again (Shake::unite).
void DenseSearch::split_bright() noexcept {
  const double aside = kSplitPitches * options_.pitch_mm, depth = aside / options_.slope_rms;
  const std::size_t count = particles_.size();
  for (std::size_t k = 0; k < count; ++k) {
    const JointParticle whole = particles_[k];
    if (whole.light < kPair * light_) continue;
    if (particles_.size() == particles_.capacity()) {
      ++refused_;
      continue;
    }
    const auto half = [&](double side) {
      const ImagePoint& at = whole.at;
      return JointParticle{{at.x + side * aside, at.y + side * aside / 2, at.z + side * depth}, whole.light / 2};
    };
    particles_[k] = half(1);
    particles_.push_back(half(-1));
  }
}

std::span<const JointParticle> DenseSearch::find(std::span<const FittedParticle> near) noexcept {
  light_ = typical_light(near);
  if (!(light_ > 0)) return {};
  search(1, kFirstScore, true);
  misfit_ = fit_.fit(particles_, {kFinalSteps, kMostLight, kExcessSigmas});
  search(kWeak, kFirstWeakScore, false);
  fit_.fit(particles_, {kFinalSteps, kMostLight, 0});
  drop_weak(options_.least_share * light_);
  misfit_ = fit_.fit(particles_, {kFinalSteps, kMostLight, 0});
  for (int round = 0; round < kPlaceRounds && try_other_places(); ++round) continue;
  search(kWeak, kFirstWeakScore, false);
  split_bright();
  fit_.fit(particles_, {kFinalSteps, kMostLight, 0});
  drop_weak(options_.least_share * light_);
  return particles_;
}

std::span<const JointParticle> DenseSearch::settle(std::span<const FittedParticle> particles) noexcept {
  particles_.clear();
  for (const auto& p : particles) particles_.push_back({p.at, p.light});
  misfit_ = fit_.fit(particles_, {kFinalSteps, kMostLight, 0});
  try_other_places();
  fit_.find_spreads(particles_, spreads_);
  widen_where_ambiguous();
  return particles_;
}

}  // namespace rptv
