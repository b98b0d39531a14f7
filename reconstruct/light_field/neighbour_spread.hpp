// SPDX-License-Identifier: MIT
// What particles that are fitted one by one do not know of each other: how much wider it makes their covariances.
#pragma once

#include <span>
#include <vector>

#include "core/image.hpp"
#include "reconstruct/light_field/joint_fit.hpp"
#include "reconstruct/light_field/particle_fit.hpp"

namespace rptv {

/// Nothing allocates after construction; one thread calls, ShakeOptions::threads work, and the result does not depend
/// on their number.
class NeighbourSpread {
 public:
  /// `lattice` must outlive this. Throws Error(configuration) without a pupil radius.
  NeighbourSpread(const LightFieldCalibration& calibration, const LensletLattice& lattice, const ShakeOptions& options);

  /// Moves all particles together, a last few steps, and gives each its `shared` covariance. `background`: grey values
  /// without light, one per pixel. Returns how many of the covariances are rough (JointSpread::cut).
  std::size_t find(const ImageView& image, std::span<const float> background,
                   std::span<FittedParticle> particles) noexcept;

 private:
  JointFit fit_;
  std::vector<float> grey_;
  std::vector<JointParticle> joint_;
  std::vector<JointSpread> spreads_;
};

}  // namespace rptv
