// SPDX-License-Identifier: MIT
// How accurately particles can be placed at all: the Cramér-Rao bound of the forward model and the camera's noise.
#pragma once

#include <span>
#include <vector>

#include "reconstruct/light_field/fit_covariance_kernel.hpp"
#include "reconstruct/light_field/particle_image.hpp"

namespace rptv {

/// A particle as it is: image space, mm; grey values in all.
struct BrightPoint {
  ImagePoint at;
  double light = 0;
};

struct PixelNoise {
  double dark_variance = 1;      ///< of a pixel without light, grey values squared
  double variance_per_grey = 0;  ///< shot noise: 1/gain
};

/// For every particle the covariance, mm², below which no unbiased estimator of all positions and lights together can
/// get: the inverse of the Fisher information Σ ∇I·∇Iᵀ/var(I) over the pixels, all particles joint, so that neighbours
/// who share pixels cost what they cost. (For Poisson light the information is exactly this; with read noise it is a
/// little more.) Infinite where the model cannot render a particle. Allocates a dense matrix of 4 rows a particle: for
/// tests and measurements.
std::vector<FitCovariance> cramer_rao_bounds(ImageModel& model, std::span<const BrightPoint> particles,
                                             const PixelNoise& noise);

}  // namespace rptv
