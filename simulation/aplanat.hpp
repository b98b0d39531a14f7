// SPDX-License-Identifier: MIT
// An ideal infinity-corrected objective with its tube lens: sine condition, telecentric on both sides (4f).
#pragma once

#include "simulation/main_lens.hpp"

namespace rptv {

/// Particles emit evenly in all directions in a medium of index n behind a plane window, and the objective takes the
/// angles n sin(w) = sin(a) <= NA in air. It images its focal plane perfectly; that plane is where paraxial rays seem
/// to come from, window/n behind the window, so that object z = 0 is conjugate to the array. A window (cover) of glass
/// is part of the objective's correction, the layer of medium is not: its spherical aberration stays.
class Aplanat : public MainLens {
 public:
  explicit Aplanat(const MainLensSettings& lens);
  void trace(const Vector3& object, double body_mm, std::span<const RaySample> samples, double turn_rad,
             std::span<ArrayRay> rays) const noexcept override;
  void white(double x_mm, double y_mm, double reach_mm, std::span<const RaySample> samples,
             std::span<ArrayRay> rays) const noexcept override;

 private:
  double aperture_, magnification_, index_, window_mm_;
  double mean_weight_;  ///< of emission over the pupil, so that weights are 1 on average
};

}  // namespace rptv
