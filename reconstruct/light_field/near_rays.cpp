// SPDX-License-Identifier: MIT
// Which rays pass near a point: loops for any processor, and the choice among all.
#include "reconstruct/light_field/near_rays.hpp"

#include "reconstruct/light_field/near_rays_loops.hpp"

namespace rptv {

namespace {

// Both write a ray whether it is near or not, which cannot be predicted, and count it only if it is.
std::size_t find(const Ray* rays, std::size_t first, std::size_t last, const RaySearch& s, NearList near) noexcept {
  std::size_t found = 0;
  for (std::size_t i = first; i < last; ++i) {
    near.number[found] = static_cast<std::uint32_t>(i);
    near.distance_mm[found] = distance_mm(rays[i], s);
    found += near.distance_mm[found] <= s.reach ? 1 : 0;
  }
  return found;
}

void gather(const Ray* rays, const std::uint8_t* taken, std::size_t first, std::size_t last, const RaySearch& s,
            RayColumns& near) noexcept {
  for (std::size_t i = first; i < last; ++i) near.push_if(rays[i], taken[i] == 0 && distance_mm(rays[i], s) <= s.reach);
}

void keep(const RaySearch& s, RayColumns& near) noexcept {
  const std::size_t all = near.size;
  near.size = 0;
  for (std::size_t i = 0; i < all; ++i) {
    const Ray ray = near[i];
    near.push_if(ray, distance_mm(ray, s) <= s.reach);
  }
}

const NearRayLoops& loops_for(InstructionSet set) noexcept {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return kNearRayLoopsAvx512;
  if (set == InstructionSet::avx2) return kNearRayLoopsAvx2;
#endif
  static_cast<void>(set);
  return kNearRayLoopsPlain;
}

}  // namespace

const NearRayLoops kNearRayLoopsPlain{find, gather, keep};

NearRays::NearRays(const RayWindow& window, std::size_t max_rays, InstructionSet set)
    : window_(window),
      loops_(loops_for(set)),
      number_(max_rays + NearList::kSlack),
      distance_mm_(max_rays + NearList::kSlack) {}

std::span<const std::uint32_t> NearRays::find(const Rays& rays, const RayGate& gate, const ImagePoint& at,
                                              double reach_mm) noexcept {
  const RaySearch search = search_of(gate, at, reach_mm);
  found_ = 0;
  window_.visit(rays, at, reach_mm, [&](std::size_t first, std::size_t last) {
    found_ += loops_.find(rays.ray.data(), first, last, search, {&number_[found_], &distance_mm_[found_]});
  });
  return {number_.data(), found_};
}

void NearRays::gather(const Rays& rays, std::span<const std::uint8_t> taken, const RayGate& gate, const ImagePoint& at,
                      double reach_mm, RayColumns& near) const noexcept {
  const RaySearch search = search_of(gate, at, reach_mm);
  near.size = 0;
  window_.visit(rays, at, reach_mm, [&](std::size_t first, std::size_t last) {
    loops_.gather(rays.ray.data(), taken.data(), first, last, search, near);
  });
}

void NearRays::keep(const RayGate& gate, const ImagePoint& at, double reach_mm, RayColumns& near) const noexcept {
  loops_.keep(search_of(gate, at, reach_mm), near);
}

}  // namespace rptv
