// SPDX-License-Identifier: MIT
// Rays in blocks through all surfaces, by the widest instructions that the machine has.
#include "simulation/lens_tracer.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace rptv {

namespace {

constexpr std::size_t kBlock = 32;  // six values of 32 rays stay in the first cache

struct Block {
  std::array<double, kBlock> x, y, z, l, m, n, alive;
};

[[gnu::always_inline]] inline void pass_all(const SurfaceStep* steps, std::size_t count, Block& rays) {
  for (std::size_t step = 0; step < count; ++step) {
    const SurfaceStep surface = steps[step];
    for (std::size_t i = 0; i < kBlock; ++i) {
      const bool passed = pass_surface(surface, rays.x[i], rays.y[i], rays.z[i], rays.l[i], rays.m[i], rays.n[i]);
      rays.alive[i] = passed ? rays.alive[i] : 0.0;
    }
  }
}

using PassAll = void (*)(const SurfaceStep*, std::size_t, Block&);

void pass_all_plain(const SurfaceStep* steps, std::size_t count, Block& rays) { pass_all(steps, count, rays); }

#if defined(__x86_64__)
[[gnu::target("avx2")]] void pass_all_avx2(const SurfaceStep* steps, std::size_t count, Block& rays) {
  pass_all(steps, count, rays);
}
[[gnu::target("avx512f,avx512dq,avx512vl")]] void pass_all_avx512(const SurfaceStep* steps, std::size_t count,
                                                                  Block& rays) {
  pass_all(steps, count, rays);
}
PassAll widest() {
  if (__builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) return pass_all_avx512;
  return __builtin_cpu_supports("avx2") ? pass_all_avx2 : pass_all_plain;
}
#else
PassAll widest() { return pass_all_plain; }
#endif

}  // namespace

LensTracer::LensTracer(const Prescription& lens, double stop_radius_mm, std::span<const Rim> rims) {
  constexpr double kNoRim = std::numeric_limits<double>::infinity();
  double z = 0, before = 1;
  stop_ = lens.stop;
  stop_radius_ = stop_radius_mm > 0 ? stop_radius_mm : lens.surfaces[lens.stop].clear_radius_mm;
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
    const LensSurface& surface = lens.surfaces[i];
    const double clear = i == lens.stop ? stop_radius_ : surface.clear_radius_mm;
    ahead_.push_back(
        {z, surface.curvature(), surface.conic, clear > 0 ? clear * clear : kNoRim, before / surface.index_after});
    before = surface.index_after;
    z += surface.thickness_mm;
  }
  for (const Rim& rim : rims) {
    const auto behind = std::find_if(ahead_.begin(), ahead_.end(), [&](const auto& step) { return step.z > rim.z_mm; });
    const auto place = static_cast<std::size_t>(behind - ahead_.begin());
    ahead_.insert(behind, {rim.z_mm, 0, 0, rim.radius_mm * rim.radius_mm, 1});
    if (place <= stop_) ++stop_;
  }
  back_.assign(ahead_.rbegin(), ahead_.rend());
  for (SurfaceStep& step : back_) step.ratio = 1 / step.ratio;
}

void LensTracer::pass_many(std::span<const SurfaceStep> steps, std::span<LensRay> rays) const noexcept {
  static const PassAll pass = widest();
  for (std::size_t first = 0; first < rays.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, rays.size() - first);
    Block block;
    for (std::size_t i = 0; i < kBlock; ++i) {
      const LensRay& ray = rays[first + std::min(i, count - 1)];
      block.x[i] = ray.x, block.y[i] = ray.y, block.z[i] = ray.z;
      block.l[i] = ray.l, block.m[i] = ray.m, block.n[i] = ray.n;
      block.alive[i] = 1;
    }
    pass(steps.data(), steps.size(), block);
    for (std::size_t i = 0; i < count; ++i)
      rays[first + i] = {block.x[i], block.y[i], block.z[i],
                         block.l[i], block.m[i], block.alive[i] != 0 ? block.n[i] : 0.0};
  }
}

bool LensTracer::pass_one(std::span<const SurfaceStep> steps, LensRay& ray) const noexcept {
  for (const SurfaceStep& step : steps)
    if (!pass_surface(step, ray.x, ray.y, ray.z, ray.l, ray.m, ray.n)) return false;
  return true;
}

bool LensTracer::forward(LensRay& ray) const noexcept { return pass_one(ahead_, ray); }
bool LensTracer::backward(LensRay& ray) const noexcept { return pass_one(back_, ray); }

double LensTracer::height_at_stop(LensRay ray) const noexcept {
  const bool with_light = ray.n > 0;
  const std::span<const SurfaceStep> steps = with_light ? ahead_ : back_;
  const std::size_t stop = with_light ? stop_ : steps.size() - 1 - stop_;
  if (!pass_one(steps.first(stop), ray)) return -1;
  SurfaceStep open = steps[stop];
  open.rim2 = std::numeric_limits<double>::infinity();
  open.ratio = 1;
  return pass_surface(open, ray.x, ray.y, ray.z, ray.l, ray.m, ray.n) ? std::hypot(ray.x, ray.y) : -1;
}

}  // namespace rptv
