// SPDX-License-Identifier: MIT
// The DLT on any processor, two tuples in a vector; the slow way for bad tuples; and the choice of instruction set.
#include "reconstruct/multi_view/dlt.hpp"

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
  DltNormal<double> normal;
  sum_rows(rows, lane, normal);
  DltPoint<double> point;
  solve_normal_slowly(normal, point);
  out.x[lane] = point.x, out.y[lane] = point.y, out.z[lane] = point.z, out.s[lane] = std::sqrt(point.square);
}

Dlt::Dlt(InstructionSet set) noexcept : solve_(solve_any) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) solve_ = solve_dlt_avx512;
  if (set == InstructionSet::avx2) solve_ = solve_dlt_avx2;
#endif
  static_cast<void>(set);
}

}  // namespace rptv
