// SPDX-License-Identifier: MIT
// Which rays belong to a point. Host and device.
#pragma once

#include <cmath>

#include "reconstruct/light_field/n_ray_fit_kernel.hpp"

namespace rptv {

/// Which rays belong to a particle: those whose offset lies in a square, turned like the lenslets, whose half-width is
/// half a pitch (the position is quantised by it) plus the particle's radius plus what blur makes of the depth.
struct RayGate {
  double cosine = 1, sine = 0;
  double half_width_mm = 0;
  double per_depth = 0;  ///< growth with |z|

  RPTV_HOST_DEVICE double half_width_at(double z) const noexcept { return half_width_mm + per_depth * fabs(z); }
  /// Offset in the lenslets' axes, maximum norm, mm.
  RPTV_HOST_DEVICE double distance(const RayOffset& r) const noexcept {
    const double along = fabs(cosine * r.x + sine * r.y), across = fabs(cosine * r.y - sine * r.x);
    return along > across ? along : across;
  }
};

}  // namespace rptv
