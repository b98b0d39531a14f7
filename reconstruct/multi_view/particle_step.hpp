// SPDX-License-Identifier: MIT
// One Gauss-Newton step of a particle's place and light against what all views have left of their images.
#pragma once

#include <array>
#include <cstddef>

#include "calibration/cameras/camera_model.hpp"
#include "calibration/space.hpp"
#include "core/particles.hpp"
#include "reconstruct/multi_view/view_spot.hpp"

namespace rptv {

/// The normal equations of (x, y, z, grey), in mm and grey values. A residual image says what to change: the particle's
/// own image is in what was taken away.
class ParticleStep {
 public:
  /// `gain`: light of a particle in this view per its grey.
  void add(const SpotSums& sums, const PixelJacobian& px_per_mm, double grey, double gain) noexcept;

  /// Solves. A place is held where it is by a prior of `prior_mm` (standard deviation), so that a particle without
  /// light stays.
  void solve(double prior_mm) noexcept;

  const Point3& shift_mm() const noexcept { return shift_mm_; }
  double more_grey() const noexcept { return more_grey_; }
  /// Of the place, as the noise of the pixels makes it.
  const Covariance& covariance_mm2() const noexcept { return covariance_mm2_; }

 private:
  std::array<std::array<double, 4>, 4> normal_{};
  std::array<double, 4> right_{};
  Point3 shift_mm_{};
  double more_grey_ = 0;
  Covariance covariance_mm2_{};
};

}  // namespace rptv
