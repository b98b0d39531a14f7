// SPDX-License-Identifier: MIT
// A particle of the light of two may be two: how much wider that makes its covariance.
#pragma once

#include <span>
#include <vector>

#include "reconstruct/light_field/particle_fit.hpp"
#include "reconstruct/light_field/particle_image.hpp"
#include "reconstruct/light_field/shake_options.hpp"
#include "reconstruct/light_field/shake_step.hpp"

namespace rptv {

/// Two particles that the image does not tell apart are found at their middle, and each is off by half their distance,
/// which the normal matrix knows nothing of. Nothing allocates after construction; one thread calls.
class PairSpread {
 public:
  /// `lattice` must outlive this. Throws Error(configuration) without a pupil radius.
  PairSpread(const LightFieldCalibration& calibration, const LensletLattice& lattice, const ShakeOptions& options);

  /// Adds the square of that half distance, along each axis, to the covariances of those that are brighter than the
  /// others' lights, a log-normal distribution, explain. `explained`: light of all particles, per pixel of the sensor.
  void widen(std::span<FittedParticle> particles, std::span<const float> explained) noexcept;

 private:
  double least_light(std::span<const FittedParticle> particles) noexcept;
  bool add_halves(const FittedParticle& pair, const ImagePoint& half) noexcept;
  void clear_halves(const FittedParticle& pair, const ImagePoint& half) noexcept;
  double half_distance(const FittedParticle& pair, const ImagePoint& direction,
                       std::span<const float> explained) noexcept;

  const ShakeOptions options_;
  const ChiefRay chief_;
  ImageModel model_;
  ParticleImage one_, half_;
  std::vector<float> halves_;  // workspace: the image of the two, grey values; 0 elsewhere
  std::vector<float> lights_;  // workspace
};

}  // namespace rptv
