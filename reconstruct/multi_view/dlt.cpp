// SPDX-License-Identifier: MIT
// The DLT on any processor, two tuples in a vector; the slow way for bad tuples; and the choice of instruction set.
#include "reconstruct/multi_view/dlt.hpp"

#include <algorithm>
#include <cmath>

#include "reconstruct/multi_view/dlt_loops.hpp"

namespace rptv {

namespace {

using Double2 [[gnu::vector_size(16)]] = double;

void solve_any(std::span<const DltRow> rows, DltSolutions& out) noexcept { solve_dlt_lanes<Double2>(rows, out); }

}  // namespace

DltRowPair dlt_rows(const std::array<std::array<double, 4>, 3>& projection, double u_px, double v_px) noexcept {
  DltRowPair rows;
  for (std::size_t k = 0; k < 4; ++k) {
    rows[0][k] = v_px * projection[2][k] - projection[1][k];
    rows[1][k] = projection[0][k] - u_px * projection[2][k];
  }
  return rows;
}

void solve_slowly(std::span<const DltRow> rows, std::size_t lane, DltSolutions& out) noexcept {
  constexpr int kMostSteps = 100;
  constexpr double kMoved = 1e-13;  // of a vector of length 1
  DltNormal<double> normal;
  sum_rows(rows, lane, normal);
  DltFactors<double> factors;
  factorise(normal, factors);
  Homogeneous<double> h;
  first_step(factors, h);
  double moved = 1, square = 0, x = 0, y = 0, z = 0, w = 0;
  for (int step = 0; step < kMostSteps && moved > kMoved; ++step) {
    next_step(factors, h, square);
    const double scale = std::copysign(1 / std::hypot(std::hypot(h.x, h.y), std::hypot(h.z, h.w)), h.w);
    square *= scale * scale;
    h.x *= scale, h.y *= scale, h.z *= scale, h.w *= scale;
    moved = std::abs(h.x - x) + std::abs(h.y - y) + std::abs(h.z - z) + std::abs(h.w - w);
    x = h.x, y = h.y, z = h.z, w = h.w;
  }
  out.x[lane] = x / w, out.y[lane] = y / w, out.z[lane] = z / w, out.s[lane] = std::sqrt(std::max(square, 0.0));
}

Dlt::Dlt(InstructionSet set) noexcept : solve_(solve_any) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) solve_ = solve_dlt_avx512;
  if (set == InstructionSet::avx2) solve_ = solve_dlt_avx2;
#endif
  static_cast<void>(set);
}

}  // namespace rptv
