// SPDX-License-Identifier: MIT
// What shaking must know about the camera, and how far it goes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "reconstruct/light_field/particle_image.hpp"

namespace rptv {

/// χ² that a particle must explain: four parameters do not get there by noise.
inline constexpr double kLeastGain = 30;

struct ShakeOptions {
  ImageModelOptions model;
  std::int64_t sweeps = 3;        ///< over all particles
  double dark_noise_grey = 1;     ///< rms of a pixel without light, grey values
  double electrons_per_grey = 4;  ///< gain: what makes shot noise of light
  double lowest_z_mm = 0, highest_z_mm = 0;
  double shallow_mm = 0;  ///< |z| below which few lenslets see a particle: its depth is searched, not stepped to
  double pitch_mm = 0, slope_rms = 0;  ///< of the lenslets; of a particle's rays along an axis
  double subimage_px = 1;              ///< diameter of a lenslet's image of the pupil
  double satellite_mm = 0;   ///< aside of a much brighter particle, within the shallow depth: its light, badly modelled
  double lit_grey = 1;       ///< a pixel that a particle makes brighter than this supports it
  double least_share = 0.1;  ///< of the median particle's light: below it is a ghost
  std::size_t max_particles = 4096;
  std::size_t max_pixels = 1 << 16;  ///< of one particle's image
  std::size_t threads = 1;
};

}  // namespace rptv
