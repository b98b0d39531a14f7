// SPDX-License-Identifier: MIT
// Volumes and rays for property tests of the ray counter's backends.
#pragma once

#include <rapidcheck.h>

#include <limits>
#include <random>

#include "reconstruct/light_field/ray_count_kernel.hpp"
#include "reconstruct/light_field/rays.hpp"

namespace rptv::testing {

struct AnyRays {
  VoxelGrid grid;
  Rays rays{0, 1};
};

// Rays in and far outside of the volume, steep and flat, some of them many times over, one that is no number.
inline AnyRays any_rays() {
  using rc::gen::inRange;
  AnyRays any;
  any.grid.size_x = *inRange(1, 80), any.grid.size_y = *inRange(1, 60), any.grid.planes = *inRange(1, 40);
  any.grid.step_x_mm = 0.125F, any.grid.step_y_mm = 0.11F, any.grid.step_z_mm = 0.7F, any.grid.first_z_mm = -9;
  std::mt19937 random(*inRange(0U, 1U << 30));
  std::uniform_real_distribution<float> at(-4, 14), slope(-0.3F, 0.3F);
  const auto count = *inRange<std::size_t>(0, 3000);
  const auto repeats = *inRange<std::size_t>(1, 60);
  const auto flatness = *rc::gen::element(0.0F, 0.01F, 0.1F, 1.0F);
  any.rays = Rays(count, 1);
  for (std::size_t i = 0; i < count; ++i)
    any.rays.ray[i] = i % repeats != 0
                          ? any.rays.ray[i - 1]
                          : Ray{at(random), at(random), flatness * slope(random), flatness * slope(random)};
  if (count > 5) any.rays.ray[5].slope_x = std::numeric_limits<float>::quiet_NaN();
  any.rays.size = any.rays.pixels = count;
  return any;
}

}  // namespace rptv::testing
