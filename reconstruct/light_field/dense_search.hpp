// SPDX-License-Identifier: MIT
// Particles found in the grey values themselves, where so many overlap that no lit pixel is one particle's.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/image.hpp"
#include "reconstruct/light_field/joint_fit.hpp"
#include "reconstruct/light_field/other_places.hpp"
#include "reconstruct/light_field/particle_fit.hpp"
#include "reconstruct/light_field/residual_search.hpp"
#include "reconstruct/light_field/shake_options.hpp"

namespace rptv {

/// Rounds of search and fit, after iterative particle reconstruction (Wieneke 2013): where whole particles would fit
/// into what is left of the image, they are added, surest first, and all are fitted together; each round is content
/// with less. Two things keep a particle from standing for two between which it lies: light that is left over does not
/// pull it (JointGoal::excess_sigmas), and until the end none is brighter than the median. Nothing allocates after
/// construction; one thread calls, `threads` work, and the result does not depend on their number.
class DenseSearch {
 public:
  /// `lattice` must outlive this. Throws Error(configuration) as Footprints and JointFit do.
  DenseSearch(const LightFieldCalibration& calibration, const LensletLattice& lattice, const ShakeOptions& options);

  /// Starts a frame. `background`: grey values without light, one per pixel.
  void begin(const ImageView& image, std::span<const float> background) noexcept;
  /// Finds all particles of the frame; many of them are near the places of `near`, which show how bright one is.
  /// Valid until the next call.
  std::span<const JointParticle> find(std::span<const FittedParticle> near) noexcept;
  /// Fits once more, from where these are; as find().
  std::span<const JointParticle> settle(std::span<const FittedParticle> particles) noexcept;
  /// Of what settle() returned, in its order.
  std::span<const JointSpread> spreads() const noexcept { return {spreads_.data(), particles_.size()}; }
  /// Of this frame, beyond the room: particles, and places where one would fit.
  std::uint64_t refused() const noexcept { return refused_; }
  std::uint64_t refused_hits() const noexcept { return refused_hits_; }

 private:
  double typical_light(std::span<const FittedParticle> near) noexcept;
  std::size_t add_hits(double light, float least_score) noexcept;
  void search(double share, float first_score, bool capped) noexcept;
  void drop_weak(double least_light) noexcept;
  void follow_light() noexcept;
  bool try_other_places() noexcept;
  void split_bright() noexcept;
  void widen_where_ambiguous() noexcept;

  const ShakeOptions options_;
  Footprints footprints_;
  ResidualSearch search_;
  JointFit fit_;
  ImageModel model_;
  ParticleImage image_;
  std::vector<OtherPlaces> other_places_;  // per thread
  double light_ = 0;                       // of a typical particle
  std::vector<float> grey_, residual_, ratios_, lights_;
  std::vector<JointParticle> particles_, before_;
  double misfit_ = 0;
  std::vector<JointSpread> spreads_;
  std::uint64_t refused_ = 0, refused_hits_ = 0;
};

}  // namespace rptv
