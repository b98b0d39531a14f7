// SPDX-License-Identifier: MIT
// The loops behind near_rays.hpp, compiled for several instruction sets, in one arithmetic.
#pragma once

#include "reconstruct/light_field/near_rays.hpp"
#include "reconstruct/light_field/near_rays_kernel.hpp"

namespace rptv {

/// One set of loops; all sets give the same. Arguments as those of NearRays.
struct NearRayLoops {
  std::size_t (*find)(const Ray* rays, std::size_t first, std::size_t last, const RaySearch& search,
                      NearList near) noexcept;
  void (*gather)(const Ray* rays, const std::uint8_t* taken, std::size_t first, std::size_t last,
                 const RaySearch& search, RayColumns& near) noexcept;
  void (*keep)(const RaySearch& search, RayColumns& near) noexcept;
};

extern const NearRayLoops kNearRayLoopsPlain;
#if defined(__x86_64__)
extern const NearRayLoops kNearRayLoopsAvx2;
extern const NearRayLoops kNearRayLoopsAvx512;
#endif

}  // namespace rptv
