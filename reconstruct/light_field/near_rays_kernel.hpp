// SPDX-License-Identifier: MIT
// How far a ray passes from a point, in single precision. Host and device.
#pragma once

#include <cmath>

#include "reconstruct/light_field/ray_gate_kernel.hpp"

namespace rptv {

/// A point, the gate's turn and a reach, in single precision.
struct RaySearch {
  float x, y, z, cosine, sine, reach;
};

RPTV_HOST_DEVICE inline RaySearch search_of(const RayGate& gate, const ImagePoint& at, double reach_mm) noexcept {
  return {static_cast<float>(at.x),        static_cast<float>(at.y),      static_cast<float>(at.z),
          static_cast<float>(gate.cosine), static_cast<float>(gate.sine), static_cast<float>(reach_mm)};
}

/// RayGate::distance() of the ray's offset, mm.
RPTV_HOST_DEVICE inline float distance_mm(const Ray& ray, const RaySearch& s) noexcept {
  const float r_x = ray.centre_x + ray.slope_x * s.z - s.x, r_y = ray.centre_y + ray.slope_y * s.z - s.y;
  const float along = fabsf(s.cosine * r_x + s.sine * r_y), across = fabsf(s.cosine * r_y - s.sine * r_x);
  return along > across ? along : across;
}

}  // namespace rptv
