// SPDX-License-Identifier: MIT
// Chain rule from a spot's sums to the particle, and the elimination of its light.
#include "reconstruct/multi_view/particle_step.hpp"

#include <algorithm>

#include "calibration/space_algebra.hpp"

namespace rptv {

void ParticleStep::add(const SpotSums& sums, const PixelJacobian& px_per_mm, double grey, double gain) noexcept {
  const double light = grey * gain, uu = sums.uu * light * light, uv = sums.uv * light * light;
  const double vv = sums.vv * light * light, um = sums.um * light * gain, vm = sums.vm * light * gain;
  const auto& [u, v] = px_per_mm;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      normal_[i][k] += uu * u[i] * u[k] + uv * (u[i] * v[k] + v[i] * u[k]) + vv * v[i] * v[k];
    normal_[i][3] += um * u[i] + vm * v[i];
    right_[i] += light * (sums.ur * u[i] + sums.vr * v[i]);
  }
  normal_[3][3] += sums.mm * gain * gain;
  right_[3] += sums.mr * gain;
}

// Schur complement: the place first, then the light that goes with it.
void ParticleStep::solve(double prior_mm) noexcept {
  const double per_light = 1 / std::max(normal_[3][3], 1e-12), prior = 1 / (prior_mm * prior_mm);
  Matrix3 place;
  Point3 right;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      place[i][k] = normal_[i][k] - normal_[i][3] * normal_[k][3] * per_light + (i == k ? prior : 0);
    right[i] = right_[i] - normal_[i][3] * right_[3] * per_light;
  }
  const Matrix3 covariance = inverse(place);
  shift_mm_ = covariance * right;
  more_grey_ = per_light *
               (right_[3] - normal_[0][3] * shift_mm_[0] - normal_[1][3] * shift_mm_[1] - normal_[2][3] * shift_mm_[2]);
  covariance_mm2_ = {covariance[0][0], covariance[0][1], covariance[0][2],
                     covariance[1][1], covariance[1][2], covariance[2][2]};
}

}  // namespace rptv
