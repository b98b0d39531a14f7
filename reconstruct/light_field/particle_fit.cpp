// SPDX-License-Identifier: MIT
// Gated N-ray least squares.
#include "reconstruct/light_field/particle_fit.hpp"

#include <algorithm>

namespace rptv {

namespace {
constexpr int kWideSteps = 2;  // with the candidate's uncertainty added to the gate
constexpr int kMostSteps = 10;
constexpr double kStillMm = 5e-4;  // a step smaller than this (along z: a hundred times) ends the iteration
}  // namespace

ParticleFit::ParticleFit(const RayWindow& window, const FitOptions& options, std::size_t max_rays)
    : slope_half_range_(window.slope_half_range()), options_(options), search_(window, max_rays), near_(max_rays) {}

FittedParticle ParticleFit::fit(const Rays& rays, std::span<const std::uint8_t> taken, const ImagePoint& start,
                                FitFor purpose) noexcept {
  const double gather_mm =
      options_.gate.half_width_at(start.z) + 2 * options_.start_margin_mm + slope_half_range_ * options_.start_depth_mm;
  search_.gather(rays, taken, options_.gate, start, gather_mm, near_);
  if (static_cast<double>(near_.size) < options_.min_support) return {};
  ImagePoint at = start;
  for (int step = 0; step < kMostSteps; ++step) {
    const double margin = step < kWideSteps ? options_.start_margin_mm : 0;
    if (step == kWideSteps)  // the point is almost there: rays far from it will not matter any more
      search_.keep(options_.gate, at, options_.gate.half_width_at(at.z) + options_.start_margin_mm / 2, near_);
    const RaySums sums = sum_within(at, options_.gate.half_width_at(at.z) + margin);
    if (sums.w < options_.min_support) return {};
    const RayFit step_to = solve(sums, options_.slope_variance, at.z);
    if (step_to.slope_spread <= 0) return {};
    at = {at.x + step_to.dx, at.y + step_to.dy, at.z + step_to.dz};
    if (step >= kWideSteps && std::abs(step_to.dx) + std::abs(step_to.dy) < kStillMm &&
        std::abs(step_to.dz) < 100 * kStillMm)
      break;
  }
  return finish(at, purpose);
}

FittedParticle ParticleFit::fit_owned(const Rays& rays, std::span<const std::uint32_t> near,
                                      std::span<const std::int32_t> owner, std::int32_t self, const ImagePoint& start,
                                      FitFor purpose) noexcept {
  near_.size = 0;
  for (const std::uint32_t i : near) near_.push_if(rays.ray[i], owner[rays.pixel[i]] == self);
  return finish(start, purpose);
}

// The step from `at` with the gathered rays inside the gate, and what is known about the point that it leads to.
FittedParticle ParticleFit::finish(const ImagePoint& at, FitFor purpose) const noexcept {
  const RaySums sums = sum_within(at, options_.gate.half_width_at(at.z));
  if (sums.w < options_.min_support) return {};
  const RayFit step = solve(sums, options_.slope_variance, at.z);
  if (step.slope_spread <= 0) return {};
  FittedParticle found;
  found.at = {at.x + step.dx, at.y + step.dy, at.z + step.dz};
  found.support = sum_within(found.at, options_.gate.half_width_at(found.at.z)).w;
  if (purpose == FitFor::place) return found;
  found.residual_mm = std::sqrt(step.wrr / sums.w);
  found.covariance = covariance_at(found, sums, step);
  return found;
}

FitCovariance ParticleFit::covariance_at(const FittedParticle& found, const RaySums& sums,
                                         const RayFit& step) const noexcept {
  const double half_width_mm = options_.gate.half_width_at(found.at.z);
  LensletScores scores;
  for (std::size_t i = 0; i < near_.size; ++i) {
    const Ray ray = near_[i];
    const RayOffset r = offset_of(ray, found.at);
    if (options_.gate.distance(r) <= half_width_mm) scores.add(ray, r);
  }
  scores.close();
  return covariance_of(sums, step, scores, options_.pitch_mm * options_.pitch_mm / 12);
}

double ParticleFit::support_at(const Rays& rays, std::span<const std::uint8_t> taken,
                               const ImagePoint& point) noexcept {
  std::size_t support = 0;
  for (const std::uint32_t i : find_near(rays, point)) support += taken[i] == 0 ? 1 : 0;
  return static_cast<double>(support);
}

}  // namespace rptv
