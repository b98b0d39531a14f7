// SPDX-License-Identifier: MIT
// What explaining away means, apart from who does it. Host and device.
#pragma once

#include "reconstruct/light_field/particle_fit_kernel.hpp"

namespace rptv {

constexpr double kClaimWider = 1.2;  // a particle also takes the crumbs just outside its gate, else they make ghosts
constexpr int kSettlePasses = 3;

/// Which fits are particles.
struct ExplainLimits {
  FitOptions fit;
  double lowest_z_mm = 0;  ///< particles outside are refused
  double highest_z_mm = 0;

  RPTV_HOST_DEVICE bool accept(double support, double z_mm) const noexcept {
    return support >= fit.min_support && z_mm >= lowest_z_mm && z_mm <= highest_z_mm;
  }
};

}  // namespace rptv
