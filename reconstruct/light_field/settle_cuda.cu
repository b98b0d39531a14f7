// SPDX-License-Identifier: MIT
// Each pixel to the particle whose ray it fits best, then a fit of each particle's own rays: ExplainAway::settle().
#include "reconstruct/cuda_compact.hpp"
#include "reconstruct/light_field/explain_away_cuda.hpp"
#include "reconstruct/light_field/near_rays_cuda.hpp"

namespace rptv {

namespace {

// Of a pixel, in CudaExplain::next: the distance of its ray from the nearest particle, in half-widths of the gate, as
// bits (distances are not negative, so bits have their order), then the particle.
__device__ CudaTurn nearness(float distance, std::uint32_t particle) {
  return (static_cast<CudaTurn>(__float_as_uint(distance)) << 32U) | particle;
}

// Pixels are nobody's, and there is no particle until one has been fitted.
__global__ void disown_pixels(CudaExplain e) {
  const std::uint32_t pixels = *e.rays.pixels;
  for (std::uint32_t i = cuda_item(); i < pixels; i += cuda_stride()) e.next[i] = nearness(1.0F, 0xFFFFFFFFU);
  for (std::uint32_t k = cuda_item(); k < e.particle_capacity; k += cuda_stride()) e.weak[k] = 1;
}

__global__ void assign_pixels(CudaExplain e) {
  for (std::uint32_t k = cuda_item() / kWarp; k < e.explained->particles; k += cuda_stride() / kWarp) {
    const ImagePoint at = e.particle[k].at;
    const double half_width_mm = e.limits.fit.gate.half_width_at(at.z);
    const auto per_half_width = static_cast<float>(1 / half_width_mm);
    const RaySearch search = search_of(e.limits.fit.gate, at, half_width_mm);
    visit_near(e.window, e.rays, at, half_width_mm, [&](std::uint32_t ray, bool real) {
      const float distance = real ? distance_mm(e.rays.ray[ray], search) : 0;
      if (!real || !(distance <= search.reach) || !(distance * per_half_width < 1.0F)) return true;
      atomicMin(&e.next[e.rays.pixel[ray]], nearness(distance * per_half_width, k));
      return true;
    });
  }
}

__global__ void fit_own_rays(CudaExplain e, FitFor purpose) {
  RPTV_SHARED(WarpSums, sums);
  const std::uint32_t warp = cuda_item() / kWarp, particles = warp < e.warps ? e.explained->particles : 0;
  const FitOptions& fit = e.limits.fit;
  for (std::uint32_t k = warp; k < particles; k += e.warps) {
    const ImagePoint start = e.particle[k].at;
    const double half_width_mm = fit.gate.half_width_at(start.z);
    const RaySearch search = search_of(fit.gate, start, half_width_mm);
    WarpNear near{e.rays, fit.gate, e.near + std::size_t{warp} * e.near_capacity, e.near_capacity, sums};
    visit_near(e.window, e.rays, start, half_width_mm, [&](std::uint32_t ray, bool real) {
      const bool inside = real && distance_mm(e.rays.ray[ray], search) <= search.reach;
      near.append(ray, inside && static_cast<std::uint32_t>(e.next[e.rays.pixel[ray]]) == k);
      return true;
    });
    __syncwarp();
    const bool room = near.size <= near.capacity;
    FittedPoint found;
    if (room) found = last_step(near, fit, start);
    const bool strong = e.limits.accept(found.support, found.at.z);
    if (cuda_lane() == 0) {
      if (!room) atomicOr(&e.explained->unsure, kTooManyNear);
      CudaParticle fitted{found.at, found.support, 0, {}};
      if (strong && purpose == FitFor::result) {
        fitted.residual_mm = sqrt(found.step.wrr / found.sums.w);
        fitted.covariance = covariance_at(near, near.size, fit, found);
      }
      e.settled[k] = fitted;
      e.weak[k] = strong ? 0 : 1;
    }
    __syncwarp();
  }
}

struct IsStrong {
  const std::uint32_t* weak;
  __device__ bool operator()(std::uint32_t i) const { return weak[i] == 0; }
};

struct KeepParticle {
  const CudaParticle* from;
  CudaParticle* to;
  __device__ void operator()(std::uint32_t at, std::uint32_t i) const { to[at] = from[i]; }
};

}  // namespace

bool settle_cuda(const CudaExplain& e, void* stream, unsigned threads_per_block) noexcept {
  const std::size_t threads = std::size_t{e.warps} * kWarp;
  std::uint32_t* const particles = &e.explained->particles;
  for (int pass = 0; pass < kSettlePasses; ++pass) {
    const FitFor purpose = pass + 1 < kSettlePasses ? FitFor::place : FitFor::result;
    if (!launch(disown_pixels, e.rays.capacity, threads_per_block, stream, e) ||
        !launch(assign_pixels, threads, threads_per_block, stream, e) ||
        !launch(fit_own_rays, threads, threads_per_block, stream, e, purpose) ||
        !compact_cuda(IsStrong{e.weak}, KeepParticle{e.settled, e.particle}, e.particle_capacity, e.run_memory,
                      particles, e.particle_capacity, stream, threads_per_block))
      return false;
  }
  return true;
}

}  // namespace rptv
