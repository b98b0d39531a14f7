// SPDX-License-Identifier: MIT
// The logarithm of a Gaussian as a linear function, and the normal equations of a fit to it.
#pragma once

#include "reconstruct/detection/lanes.hpp"

namespace rptv {

// ln I = a + b·x + c·y + q·(x² + y²): a Gaussian centred at -b/2q, -c/2q with σ² = -1/2q.
template <class Lanes>
struct LogGaussian {
  Lanes a, b, c, q;
};

// Weighted normal equations of the four and their LDLᵀ factors.
template <class Lanes>
struct NormalEquations {
  Lanes n{}, x{}, y{}, xx{}, xy{}, yy{}, xr{}, yr{}, rr{};
  Lanes t1{}, tx{}, ty{}, tr{};
  Lanes d1, d2, d3, l10, l20, l30, l21, l31, l32;

  RPTV_LANES void add(float dx, float dy, Lanes weight, Lanes weighted_log) noexcept {
    const float r = dx * dx + dy * dy;
    const Lanes wx = weight * dx, wy = weight * dy;
    n += weight, x += wx, y += wy, xx += wx * dx, xy += wx * dy, yy += wy * dy;
    xr += wx * r, yr += wy * r, rr += weight * (r * r);
    t1 += weighted_log, tx += weighted_log * dx, ty += weighted_log * dy, tr += weighted_log * r;
  }
  RPTV_LANES LogGaussian<Lanes> solve() noexcept {
    const Lanes r = xx + yy;
    l10 = x / n, l20 = y / n, l30 = r / n;
    d1 = xx - l10 * x;
    const Lanes e21 = xy - l20 * x, e31 = xr - l30 * x;
    l21 = e21 / d1, l31 = e31 / d1;
    d2 = yy - l20 * y - l21 * e21;
    const Lanes e32 = yr - l30 * y - l31 * e21;
    l32 = e32 / d2;
    d3 = rr - l30 * r - l31 * e31 - l32 * e32;
    const Lanes z1 = tx - l10 * t1, z2 = ty - l20 * t1 - l21 * z1, z3 = tr - l30 * t1 - l31 * z1 - l32 * z2;
    LogGaussian<Lanes> fit;
    fit.q = z3 / d3;
    fit.c = z2 / d2 - l32 * fit.q;
    fit.b = z1 / d1 - l21 * fit.c - l31 * fit.q;
    fit.a = t1 / n - l10 * fit.b - l20 * fit.c - l30 * fit.q;
    return fit;
  }
  // With g the derivatives of -b/2q and -c/2q, gᵀN⁻¹g = |D^(-1/2) L⁻¹ g|².
  RPTV_LANES Lanes variance(const LogGaussian<Lanes>& fit, Lanes at_x, Lanes at_y) const noexcept {
    const Lanes u3 = at_x * 2.0F - l31 + l32 * l21, v3 = at_y * 2.0F - l32;
    const Lanes of_x = 1.0F / d1 + l21 * l21 / d2 + u3 * u3 / d3, of_y = 1.0F / d2 + v3 * v3 / d3;
    return (of_x + of_y) / (fit.q * fit.q * 8.0F);
  }
};

}  // namespace rptv
