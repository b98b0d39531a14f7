// SPDX-License-Identifier: MIT
// Steps that lower the misfit are taken; else damping grows.
#include "reconstruct/light_field/joint_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "reconstruct/light_field/poisson_gain_kernel.hpp"
#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {
constexpr float kFirstDamping = 1e-3F, kLeastDamping = 1e-5F, kEase = 0.3F, kHarden = 8;
constexpr int kMostTries = 6;
constexpr double kStillGain = 0.5;  // of all particles, in χ²: not worth another step
constexpr double kMostAsideMm = 0.03, kMostDepthMm = 1.5, kMostDepthShare = 0.2, kLeastLightShare = 0.1;
constexpr double kStillAsideMm = 1e-4, kStillDepthMm = 5e-3;  // a particle that would move less keeps its image
}  // namespace

void grey_above(const ImageView& image, std::span<const float> background, std::span<float> grey) noexcept {
  const bool bytes = image.shape.bytes_per_pixel == 1;
  for (std::size_t i = 0; i < grey.size(); ++i)
    grey[i] = (bytes ? static_cast<float>(image.as_u8()[i]) : static_cast<float>(image.as_u16()[i])) - background[i];
}

JointFitOptions make_joint_fit_options(const ShakeOptions& shake, std::size_t max_image_pixels,
                                       std::size_t mean_pixels) noexcept {
  JointFitOptions fit;
  fit.model = shake.model;
  fit.dark_variance = shake.dark_noise_grey * shake.dark_noise_grey + 1.0 / 12;
  fit.variance_per_grey = 1 / shake.electrons_per_grey;
  fit.max_particles = shake.max_particles;
  fit.max_image_pixels = max_image_pixels;
  fit.max_entries = shake.max_particles * mean_pixels * 3 / 2;
  fit.threads = shake.threads;
  return fit;
}

JointFit::JointFit(const LightFieldCalibration& calibration, const LensletLattice& lattice,
                   const JointFitOptions& options)
    : options_(options),
      workers_(options.threads,
               Worker{ImageModel(calibration, lattice, options.model), ParticleImage(options.max_image_pixels)}),
      one_(options.max_particles, options.max_entries),
      other_(options.max_particles, options.max_entries),
      normal_(static_cast<std::size_t>(calibration.sensor.width_px * calibration.sensor.height_px),
              options.max_particles, options.max_entries, options.threads),
      covariance_(options.max_particles, normal_.max_blocks(), options.threads),
      proposed_(options.max_particles) {
  const auto pixels = static_cast<std::size_t>(calibration.sensor.width_px * calibration.sensor.height_px);
  for (auto* image : {&explained_, &next_explained_, &weight_, &rest_, &per_sigma_}) image->resize(pixels);
}

void JointFit::begin(std::span<const float> grey) noexcept {
  grey_ = grey;
  std::fill(explained_.begin(), explained_.end(), 0.0F);
  const auto dark = static_cast<float>(options_.dark_variance),
             per_grey = static_cast<float>(options_.variance_per_grey);
  for (std::size_t i = 0; i < grey.size(); ++i)
    per_sigma_[i] = 1 / std::sqrt(dark + per_grey * std::max(grey[i], 0.0F));
}

// Twice the negative logarithm of the likelihood, but for a constant; or the one-sided Huber loss.
double JointFit::misfit(const JointImages& images, std::span<const JointParticle> particles, const JointGoal& goal,
                        std::vector<float>& explained) noexcept {
  std::fill(explained.begin(), explained.end(), 0.0F);
  for (std::size_t k = 0; k < particles.size(); ++k) images.paint(k, particles[k].light, explained);
  const auto dark = static_cast<float>(options_.dark_variance),
             per_grey = static_cast<float>(options_.variance_per_grey);
  const auto bend = static_cast<float>(goal.excess_sigmas);
  double sum = 0;
  if (bend > 0) {
    for (std::size_t i = 0; i < explained.size(); ++i) {
      const float t = (grey_[i] - explained[i]) * per_sigma_[i];
      sum += static_cast<double>(t > bend ? bend * (2 * t - bend) : t * t);
    }
    return sum;
  }
  for (std::size_t i = 0; i < explained.size(); ++i) {
    const float seen = std::max(dark + per_grey * grey_[i], 0.0F);
    const float expected = dark + per_grey * std::max(explained[i], 0.0F);
    sum -= static_cast<double>(poisson_gain(seen, expected, dark));
  }
  return sum / (options_.variance_per_grey * options_.variance_per_grey);
}

// Of `explained_`, as misfit() sees it.
void JointFit::weigh(const JointGoal& goal) noexcept {
  const auto dark = static_cast<float>(options_.dark_variance),
             per_grey = static_cast<float>(options_.variance_per_grey);
  const auto bend = static_cast<float>(goal.excess_sigmas);
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    rest_[i] = grey_[i] - explained_[i];
    const float t = rest_[i] * per_sigma_[i];
    weight_[i] = bend > 0 ? per_sigma_[i] * per_sigma_[i] * (t > bend ? bend / t : 1)
                          : 1 / (dark + per_grey * std::max(explained_[i], 0.0F));
  }
}

void JointFit::render_all(std::span<JointParticle> particles) noexcept {
  now_->begin(particles.size());
  parallel_for(particles.size(), options_.threads, [&](std::size_t k, std::size_t thread) {
    auto& [model, image] = workers_[thread];
    if (!model.render(particles[k].at, image) || !now_->put(k, image)) particles[k].light = 0;
  });
}

// The particles after their steps, bounded, and their images.
void JointFit::propose(std::span<const JointParticle> particles, std::span<const JointStep> steps,
                       const JointGoal& goal) noexcept {
  next_->begin(particles.size());
  parallel_for(particles.size(), options_.threads, [&](std::size_t k, std::size_t thread) {
    auto& [model, image] = workers_[thread];
    const JointParticle& from = particles[k];
    JointParticle& to = proposed_[k];
    to = from;
    if (!(from.light > 0)) return;
    const std::array<double, 4> step{steps[k][0], steps[k][1], steps[k][2], steps[k][3]};
    const double aside = std::max(std::abs(step[0]), std::abs(step[1])), depth = std::abs(step[2]);
    const double over =
        std::max({1.0, aside / kMostAsideMm, depth / (kMostDepthMm + kMostDepthShare * std::abs(from.at.z))});
    to.light = std::min(std::max(from.light + step[3] / over, kLeastLightShare * from.light), goal.most_light);
    if (aside > kStillAsideMm || depth > kStillDepthMm) {
      to.at = {from.at.x + step[0] / over, from.at.y + step[1] / over, from.at.z + step[2] / over};
      if (model.render(to.at, image) && next_->put(k, image)) return;
      to = from;
    }
    next_->copy(k, *now_);
  });
}

double JointFit::fit(std::span<JointParticle> particles, const JointGoal& goal) noexcept {
  for (auto& p : particles) p.light = std::min(p.light, goal.most_light);
  render_all(particles);
  double least = misfit(*now_, particles, goal, explained_);
  float damping = kFirstDamping;
  for (int step = 0; step < goal.steps; ++step) {
    weigh(goal);
    normal_.assemble(*now_, particles, weight_, rest_, goal.most_light);
    bool better = false;
    double gain = 0;
    for (int tries = 0; tries < kMostTries && !better; ++tries) {
      propose(particles, normal_.solve(damping), goal);
      const std::span proposed(proposed_.data(), particles.size());
      const double value = misfit(*next_, proposed, goal, next_explained_);
      gain = least - value;
      better = gain > 0;
      damping = better ? std::max(damping * kEase, kLeastDamping) : damping * kHarden;
    }
    if (!better) return least;
    least -= gain;
    std::copy_n(proposed_.begin(), particles.size(), particles.begin());
    std::swap(now_, next_);
    std::swap(explained_, next_explained_);
    if (gain < kStillGain) return least;
  }
  return least;
}

void JointFit::find_spreads(std::span<const JointParticle> particles, std::span<JointSpread> spreads) noexcept {
  const JointGoal all_light;
  weigh(all_light);
  normal_.assemble(*now_, particles, weight_, rest_, all_light.most_light);
  covariance_.find(normal_, spreads);
}

}  // namespace rptv
