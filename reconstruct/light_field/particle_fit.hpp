// SPDX-License-Identifier: MIT
// N-ray least squares round a candidate: gather the rays near it, fit, gate, repeat.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reconstruct/light_field/near_rays.hpp"
#include "reconstruct/light_field/particle_fit_kernel.hpp"
#include "reconstruct/light_field/ray_sums.hpp"

namespace rptv {

/// A particle placed by its rays, in image space.
struct FittedParticle {
  ImagePoint at;
  double support = 0;      ///< rays that it explains
  double residual_mm = 0;  ///< as covariance, only where it was asked for
  FitCovariance covariance{};
  double light = 0;        ///< grey values in all; 0: not fitted to the image
  double seen = 0;         ///< share of its light that falls on the sensor
  double gain = 0;         ///< χ² that it explains
  double agreement = 0;    ///< that over what a right model would explain; 1: nothing but noise is left
  FitCovariance shared{};  ///< what the covariance has because neighbours' places are not known either, without misfit
  double crowded = 0;      ///< share of its light that falls where other particles' does
  double ghost = 0;        ///< probability that it is none
  double chi_square = 0;   ///< per pixel of its image; about 1 where the model and the noise are right
};

/// Strong particles first.
inline bool by_support(const FittedParticle& a, const FittedParticle& b) noexcept { return a.support > b.support; }

/// One workspace per thread; nothing allocates after construction. Rays are read, never changed.
class ParticleFit {
 public:
  ParticleFit(const RayWindow& window, const FitOptions& options, std::size_t max_rays);

  /// Fits the free rays (taken[ray] == 0) near `start`. support 0: too few rays, or they give no depth.
  FittedParticle fit(const Rays& rays, std::span<const std::uint8_t> taken, const ImagePoint& start,
                     FitFor purpose) noexcept;

  /// Rays inside the gate at a point; valid until the next call of any function.
  std::span<const std::uint32_t> find_near(const Rays& rays, const ImagePoint& at) noexcept {
    return search_.find(rays, options_.gate, at, options_.gate.half_width_at(at.z));
  }
  /// One least-squares step from `start` with those of the rays inside the gate, `near`, that owner[pixel] == self.
  FittedParticle fit_owned(const Rays& rays, std::span<const std::uint32_t> near, std::span<const std::int32_t> owner,
                           std::int32_t self, const ImagePoint& start, FitFor purpose) noexcept;

  /// Free rays inside the gate at a point.
  double support_at(const Rays& rays, std::span<const std::uint8_t> taken, const ImagePoint& point) noexcept;

  const FitOptions& options() const noexcept { return options_; }

 private:
  /// The rays that are fitted, for particle_fit_kernel.hpp.
  struct Gathered {
    const NearRays& search;
    const RayGate& gate;
    RayColumns& columns;
    RaySums sum(const ImagePoint& at, double half_width_mm) const noexcept {
      return sum_rays(columns, gate, at, half_width_mm);
    }
    void keep(const ImagePoint& at, double reach_mm) noexcept { search.keep(gate, at, reach_mm, columns); }
    Ray ray(std::size_t i) const noexcept { return columns[i]; }
  };
  Gathered gathered() noexcept { return {search_, options_.gate, near_}; }
  FittedParticle finish(const ImagePoint& at, FitFor purpose) noexcept;

  const double slope_half_range_;
  const FitOptions options_;
  NearRays search_;
  RayColumns near_;  // those that are fitted
};

}  // namespace rptv
