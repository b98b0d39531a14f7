// SPDX-License-Identifier: MIT
// Where else a particle near the array would fit: few lenslets see it, and their grey values may suit several places.
#pragma once

#include <span>
#include <vector>

#include "reconstruct/light_field/particle_fit.hpp"
#include "reconstruct/light_field/particle_image.hpp"
#include "reconstruct/light_field/shake_options.hpp"
#include "reconstruct/light_field/shake_step.hpp"

namespace rptv {

/// Grey values above background, and what all particles explain of them; one per pixel of the sensor.
struct JointView {
  std::span<const float> grey, explained;
};

/// A particle's likelihood has several maxima there, and flat tops: within a cell that cuts none of its light, nothing
/// tells where it is. The maxima are found by climbing (Levenberg-Marquardt) from places a third of a pitch aside and
/// in other depths, those of the others' light known. Nothing allocates after construction; one per thread.
class OtherPlaces {
 public:
  /// `lattice` must outlive this. Throws Error(configuration) without a pupil radius.
  OtherPlaces(const LightFieldCalibration& calibration, const LensletLattice& lattice, const ShakeOptions& options,
              std::size_t max_pixels);

  /// Moves the particle, which is one of those explained, to the likeliest of its places; returns by how much χ² falls.
  double improve(FittedParticle& particle, const JointView& view) noexcept;
  /// What the other places add to its covariance, mm²: the spread of the mixture of all maxima, each with the share of
  /// the probability that it holds (Laplace's approximation), about the particle.
  FitCovariance ambiguity(const FittedParticle& particle, const JointView& view) noexcept;

 private:
  struct Place {
    FittedParticle particle;
    ShakeSums sums;
  };
  bool near_array(const FittedParticle& particle) const noexcept;
  void find(const FittedParticle& particle, const JointView& view) noexcept;
  void add_start(const ImagePoint& at, const JointView& view) noexcept;
  bool weigh(Place& place, ParticleImage& image, const JointView& view) noexcept;
  Seen look(const ParticleImage& image, const JointView& view) noexcept;
  void climb(Place& place, const JointView& view) noexcept;

  const ShakeOptions options_;
  const ChiefRay chief_;
  ImageModel model_;
  ParticleImage own_, now_;
  std::vector<float> own_light_;      // of the particle, on the sensor; 0 elsewhere
  std::vector<float> grey_, others_;  // workspace
  std::vector<Place> places_;         // the particle's own first
};

}  // namespace rptv
