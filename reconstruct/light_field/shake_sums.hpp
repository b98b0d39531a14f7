// SPDX-License-Identifier: MIT
// Normal equations of one particle's position and light against the grey values that it lights.
#pragma once

#include <array>
#include <cstddef>

#include "reconstruct/light_field/particle_image.hpp"

namespace rptv {

/// The camera's image at the pixels of a particle's image, and how noisy it is there.
struct Seen {
  const float* grey;        ///< above background, without the light of the other particles
  const float* others;      ///< light of the other particles
  float dark_variance;      ///< of a pixel without light, grey values squared
  float variance_per_grey;  ///< shot noise: 1/gain
  float misfit;             ///< rms error of the model of `others`, as a share
};

/// Sums over the pixels with weights 1/variance, shot noise of the expected light included: the Fisher information and
/// the gradient of the likelihood (poisson_gain). Parameters: x, y, z, light.
struct ShakeSums {
  std::array<double, 10> normal{};  ///< upper triangle, row by row
  std::array<double, 4> pull{};     ///< gradient: where the image wants the particle
  double gain = 0;                  ///< twice the gain in log-likelihood by the particle: the χ² that it explains
  double square = 0;                ///< χ² with it
};

ShakeSums sum_up(const ParticleImage& image, const Seen& seen, double light) noexcept;

/// The light for which the image fits best where it is, and what it explains then (as ShakeSums::gain).
struct BestLight {
  double light, gain;
};
BestLight best_light(const ParticleImage& image, const Seen& seen) noexcept;

}  // namespace rptv
