// SPDX-License-Identifier: MIT
// All particles of a frame fitted to its grey values together (Levenberg-Marquardt).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/image.hpp"
#include "reconstruct/light_field/joint_covariance.hpp"
#include "reconstruct/light_field/joint_images.hpp"
#include "reconstruct/light_field/joint_normal.hpp"
#include "reconstruct/light_field/shake_options.hpp"

namespace rptv {

struct JointFitOptions {
  ImageModelOptions model;
  double dark_variance = 1;      ///< of a pixel without light, grey values squared
  double variance_per_grey = 0;  ///< shot noise: 1/gain
  std::size_t max_particles = 4096;
  std::size_t max_image_pixels = 1 << 12;  ///< of one particle
  std::size_t max_entries = 1 << 20;       ///< pixels of all images together
  std::size_t threads = 1;
};

/// Grey values above background, one per pixel.
void grey_above(const ImageView& image, std::span<const float> background, std::span<float> grey) noexcept;

/// `mean_pixels`: of the images of the particles that a frame may have.
JointFitOptions make_joint_fit_options(const ShakeOptions& shake, std::size_t max_image_pixels,
                                       std::size_t mean_pixels) noexcept;

/// How one fit goes.
struct JointGoal {
  int steps = 10;
  double most_light = 1e30;  ///< of a particle
  /// Not 0: light that no particle explains yet may remain. A pixel brighter than the model by more than so many of its
  /// standard deviations pulls no harder than by so many (Huber 1964, on one side).
  double excess_sigmas = 0;
};

/// Overlapping particles move together, which one after the other takes very many sweeps. Nothing allocates after
/// construction; one thread calls, `threads` work, and the result does not depend on their number.
class JointFit {
 public:
  /// `lattice` must outlive this. Throws Error(configuration) without a pupil radius.
  JointFit(const LightFieldCalibration& calibration, const LensletLattice& lattice, const JointFitOptions& options);

  JointFit(const JointFit&) = delete;
  JointFit& operator=(const JointFit&) = delete;

  /// Starts a frame: grey values above background, one a pixel of the sensor; they must stay.
  void begin(std::span<const float> grey) noexcept;
  /// Moves the particles; returns χ² of all pixels, but for a constant. Those that cannot be rendered, or have no room,
  /// get no light.
  double fit(std::span<JointParticle> particles, const JointGoal& goal) noexcept;
  /// How sure each of the particles of the last fit() is, by the noise of the pixels alone.
  void find_spreads(std::span<const JointParticle> particles, std::span<JointSpread> spreads) noexcept;
  /// Light of the particles of the last fit.
  std::span<const float> explained() const noexcept { return explained_; }

 private:
  struct Worker {
    ImageModel model;
    ParticleImage image;
  };
  double misfit(const JointImages& images, std::span<const JointParticle> particles, const JointGoal& goal,
                std::vector<float>& explained) noexcept;
  void weigh(const JointGoal& goal) noexcept;
  void render_all(std::span<JointParticle> particles) noexcept;
  void propose(std::span<const JointParticle> particles, std::span<const JointStep> steps,
               const JointGoal& goal) noexcept;

  const JointFitOptions options_;
  std::vector<Worker> workers_;
  JointImages one_, other_;
  JointImages *now_ = &one_, *next_ = &other_;
  JointNormal normal_;
  JointCovariance covariance_;
  std::span<const float> grey_;
  std::vector<float> explained_, next_explained_, weight_, rest_, per_sigma_;
  std::vector<JointParticle> proposed_;
};

}  // namespace rptv
