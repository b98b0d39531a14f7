// SPDX-License-Identifier: MIT
// A three-dimensional unsteady flow with exact particle paths: transverse waves that swing every particle about its
// place.
#pragma once

#include <array>

#include "simulation/flow.hpp"

namespace rptv {

/// Sum of plane waves in Lagrangian coordinates over a uniform drift:
/// x(t) = rest + drift t + sum_i a_i sin(k_i·rest + w_i t + phase_i), with a_i across k_i, so that the swing has no
/// divergence to first order; a particle's path curves, and its acceleration changes, in every direction. Directions
/// are spread over the sphere, phases and frequencies drawn by the seed. Immutable; any thread.
class WaveFlow : public Flow {
 public:
  static constexpr std::size_t kWaves = 12;

  WaveFlow(const WavesSettings& waves, const FlowSettings& flow, std::uint64_t seed);

  Vector3 position(const Vector3& rest, double time_s) const noexcept override;
  Vector3 velocity(const Vector3& rest, double time_s) const noexcept override;
  Vector3 drift(const Vector3&) const noexcept override { return drift_; }
  Vector3 largest_drift() const noexcept override { return drift_; }
  double fastest_mm_s() const noexcept override;

 private:
  struct Wave {
    Vector3 amplitude, number;  ///< mm, 1/mm
    double omega_rad_s, phase;
    double angle(const Vector3& rest, double time_s) const noexcept {
      return number.x * rest.x + number.y * rest.y + number.z * rest.z + omega_rad_s * time_s + phase;
    }
  };
  Vector3 drift_;
  std::array<Wave, kWaves> waves_;
};

}  // namespace rptv
