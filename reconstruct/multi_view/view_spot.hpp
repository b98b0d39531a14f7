// SPDX-License-Identifier: MIT
// A particle image as the model has it, a Gaussian integrated over square pixels, and what a fit sums up of it.
#pragma once

namespace rptv {

/// Of one particle in one view; u is the column and v the row, pixel centres are integers.
struct ViewSpot {
  float u_px = 0, v_px = 0, sigma_px = 1;
  float grey = 0;  ///< sum of its grey values
};

/// Sums over a spot's pixels of weight times products of m, its share, m_u and m_v, the derivatives of that by its
/// place, and r, what is left of the image; and of weight times r².
struct SpotSums {
  float mm, um, vm, uu, uv, vv, mr, ur, vr, rr;
};

}  // namespace rptv
