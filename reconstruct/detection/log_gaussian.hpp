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

// Of a pixel: its weight, and that times the logarithm that the fit is to have there.
template <class Lanes>
struct WeightedLog {
  Lanes weight, log;
};

// Sums over a row of weight·dx⁰ … dx⁴ and of weighted logarithms·dx⁰ … dx². Pixels at -dx and dx come together: even
// powers need only their sum, odd ones their difference.
template <class Lanes>
struct RowMoments {
  Lanes w0, w1{}, w2{}, w3{}, w4{}, t0, t1{}, t2{};

  RPTV_LANES explicit RowMoments(const WeightedLog<Lanes>& middle) noexcept : w0(middle.weight), t0(middle.log) {}
  RPTV_LANES void add_pair(float dx, const WeightedLog<Lanes>& before, const WeightedLog<Lanes>& after) noexcept {
    const Lanes even = after.weight + before.weight, odd = after.weight - before.weight;
    const Lanes even_log = after.log + before.log, odd_log = after.log - before.log;
    const float dx2 = dx * dx;
    w0 += even, w1 += odd * dx, w2 += even * dx2, w3 += odd * (dx2 * dx), w4 += even * (dx2 * dx2);
    t0 += even_log, t1 += odd_log * dx, t2 += even_log * dx2;
  }
};

// Weighted normal equations of the four and their LDLᵀ factors.
template <class Lanes>
struct NormalEquations {
  Lanes n{}, x{}, y{}, xx{}, xy{}, yy{}, xr{}, yr{}, rr{};
  Lanes t1{}, tx{}, ty{}, tr{};
  Lanes d1, d2, d3, l10, l20, l30, l21, l31, l32;

  RPTV_LANES void add_row(float dy, const RowMoments<Lanes>& row) noexcept {
    const float dy2 = dy * dy;
    n += row.w0, x += row.w1, xx += row.w2, y += row.w0 * dy, xy += row.w1 * dy, yy += row.w0 * dy2;
    xr += row.w3 + row.w1 * dy2, yr += (row.w2 + row.w0 * dy2) * dy;
    rr += row.w4 + (row.w2 * 2.0F + row.w0 * dy2) * dy2;
    t1 += row.t0, tx += row.t1, ty += row.t0 * dy, tr += row.t2 + row.t0 * dy2;
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
