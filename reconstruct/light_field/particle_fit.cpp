// SPDX-License-Identifier: MIT
// Gated N-ray least squares.
#include "reconstruct/light_field/particle_fit.hpp"

#include <algorithm>

namespace rptv {

ParticleFit::ParticleFit(const RayWindow& window, const FitOptions& options, std::size_t max_rays)
    : slope_half_range_(window.slope_half_range()), options_(options), search_(window, max_rays), near_(max_rays) {}

FittedParticle ParticleFit::fit(const Rays& rays, std::span<const std::uint8_t> taken, const ImagePoint& start,
                                FitFor purpose) noexcept {
  search_.gather(rays, taken, options_.gate, start, gather_reach_mm(options_, slope_half_range_, start.z), near_);
  if (static_cast<double>(near_.size) < options_.min_support) return {};
  ImagePoint at = start;
  auto near = gathered();
  return converge(near, options_, at) ? finish(at, purpose) : FittedParticle{};
}

FittedParticle ParticleFit::fit_owned(const Rays& rays, std::span<const std::uint32_t> near,
                                      std::span<const std::int32_t> owner, std::int32_t self, const ImagePoint& start,
                                      FitFor purpose) noexcept {
  near_.size = 0;
  for (const std::uint32_t i : near) near_.push_if(rays.ray[i], owner[rays.pixel[i]] == self);
  return finish(start, purpose);
}

// The step from `at`, and what is known about the point that it leads to.
FittedParticle ParticleFit::finish(const ImagePoint& at, FitFor purpose) noexcept {
  auto near = gathered();
  const FittedPoint point = last_step(near, options_, at);
  if (!(point.support > 0)) return {};
  FittedParticle found;
  found.at = point.at, found.support = point.support;
  if (purpose == FitFor::place) return found;
  found.residual_mm = std::sqrt(point.step.wrr / point.sums.w);
  found.covariance = covariance_at(near, near_.size, options_, point);
  return found;
}

double ParticleFit::support_at(const Rays& rays, std::span<const std::uint8_t> taken,
                               const ImagePoint& point) noexcept {
  std::size_t support = 0;
  for (const std::uint32_t i : find_near(rays, point)) support += taken[i] == 0 ? 1 : 0;
  return static_cast<double>(support);
}

}  // namespace rptv
