// SPDX-License-Identifier: MIT
// Gated N-ray least squares.
#include "reconstruct/particle_fit.hpp"

#include <algorithm>

namespace rptv {

namespace {
constexpr int kWideSteps = 2;  // with the candidate's uncertainty added to the gate
constexpr int kMostSteps = 10;
constexpr double kStillMm = 5e-4;  // a step smaller than this (along z: a hundred times) ends the iteration
}  // namespace

ParticleFit::ParticleFit(const RayWindow& window, const FitOptions& options, std::size_t max_rays)
    : window_(window), options_(options), near_(max_rays) {}

FittedParticle ParticleFit::fit(const Rays& rays, std::span<const std::uint8_t> taken,
                                const ImagePoint& start) noexcept {
  const double gather_mm = options_.gate.half_width_at(start.z) + 2 * options_.start_margin_mm +
                           window_.slope_half_range() * options_.start_depth_mm;
  near_.size = 0;
  window_.visit(rays, start, gather_mm, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last && near_.size < near_.capacity(); ++i)
      if (taken[rays.pixel[i]] == 0 && options_.gate.distance(offset_of(rays.ray[i], start)) <= gather_mm)
        near_.push(rays.ray[i]);
  });
  ImagePoint at = start;
  for (int step = 0; step < kMostSteps; ++step) {
    const double margin = step < kWideSteps ? options_.start_margin_mm : 0;
    if (step == kWideSteps) keep_near(at);
    const RaySums sums = sum_within(at, options_.gate.half_width_at(at.z) + margin);
    if (sums.w < options_.min_support) return {};
    const RayFit step_to = solve(sums, options_.slope_variance, at.z);
    if (step_to.slope_spread <= 0) return {};
    at = {at.x + step_to.dx, at.y + step_to.dy, at.z + step_to.dz};
    if (step >= kWideSteps && std::abs(step_to.dx) + std::abs(step_to.dy) < kStillMm &&
        std::abs(step_to.dz) < 100 * kStillMm)
      break;
  }
  return finish(at);
}

// Once the point is almost there, rays far from it will not matter any more.
void ParticleFit::keep_near(const ImagePoint& at) noexcept {
  const double reach_mm = options_.gate.half_width_at(at.z) + options_.start_margin_mm / 2;
  near_.keep_if([&](const Ray& ray) { return options_.gate.distance(offset_of(ray, at)) <= reach_mm; });
}

FittedParticle ParticleFit::fit_owned(const Rays& rays, std::span<const std::int32_t> owner, std::int32_t self,
                                      const ImagePoint& start) noexcept {
  const double half_width_mm = options_.gate.half_width_at(start.z);
  near_.size = 0;
  window_.visit(rays, start, half_width_mm, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last && near_.size < near_.capacity(); ++i)
      if (owner[rays.pixel[i]] == self && options_.gate.distance(offset_of(rays.ray[i], start)) <= half_width_mm)
        near_.push(rays.ray[i]);
  });
  return finish(start);
}

// The step from `at` with the gathered rays inside the gate, and what is known about the point that it leads to.
FittedParticle ParticleFit::finish(const ImagePoint& at) const noexcept {
  const RaySums sums = sum_within(at, options_.gate.half_width_at(at.z));
  if (sums.w < options_.min_support) return {};
  const RayFit step = solve(sums, options_.slope_variance, at.z);
  if (step.slope_spread <= 0) return {};
  FittedParticle found;
  found.at = {at.x + step.dx, at.y + step.dy, at.z + step.dz};
  found.residual_mm = std::sqrt(step.wrr / sums.w);
  const double half_width_mm = options_.gate.half_width_at(found.at.z);
  LensletScores scores;
  for (std::size_t i = 0; i < near_.size; ++i) {
    const Ray ray = near_[i];
    const RayOffset r = offset_of(ray, found.at);
    if (options_.gate.distance(r) > half_width_mm) continue;
    ++found.support;
    scores.add(ray, r);
  }
  scores.close();
  found.covariance = covariance_of(sums, step, scores, options_.pitch_mm * options_.pitch_mm / 12);
  return found;
}

double ParticleFit::support_at(const Rays& rays, std::span<const std::uint8_t> taken,
                               const ImagePoint& point) const noexcept {
  const double half_width_mm = options_.gate.half_width_at(point.z);
  double support = 0;
  window_.visit(rays, point, half_width_mm, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      support += taken[rays.pixel[i]] == 0 && options_.gate.distance(offset_of(rays.ray[i], point)) <= half_width_mm;
  });
  return support;
}

}  // namespace rptv
