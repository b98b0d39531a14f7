// SPDX-License-Identifier: MIT
// The loops over the pixels of a particle's image, compiled for what the processor has.
#pragma once

#include <cstddef>

#include "reconstruct/light_field/particle_image_kernel.hpp"

namespace rptv {

/// A row of `count` points of one lenslet's sub-image, slopes s_x, s_x - step, …; four arrays out.
struct LightRow {
  float centre_x, centre_y;
  float s_x, step, s_y;
  std::ptrdiff_t count;
  float *value, *dx, *dy, *dz;
};

/// light_at() along a row. The same bits on every processor.
void light_row(const ParticleView& view, const LightRow& row) noexcept;

/// Pixels that light_row() and filter_line() work on at a time: counts are multiples of it.
inline constexpr std::ptrdiff_t kPixelBlock = 8;

/// to[i] = Σ_k weights[|k|]·from[i + k·step], |k| ≤ reach, for i in 0 … count - 1. Reads reach·step values before
/// `from` and behind its end. Not in place.
void filter_line(const float* from, float* to, std::ptrdiff_t count, std::ptrdiff_t step, const float* weights,
                 std::ptrdiff_t reach) noexcept;

}  // namespace rptv
