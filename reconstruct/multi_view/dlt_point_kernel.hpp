// SPDX-License-Identifier: MIT
// From a tuple's normal matrix to its point and residual, eq. (4): two steps, and as many as it takes for bad tuples.
#pragma once

#include <cmath>

#include "reconstruct/multi_view/dlt_kernel.hpp"

namespace rptv {

/// A point in the unit of A's columns, and the square of A's smallest singular value.
template <class V>
struct DltPoint {
  V x, y, z, square;
};

/// A step from distance e (of the unit of A's columns) ends at e·r, r = (s / next singular value)², and the
/// least-squares point is already |point|·r from the solution: one step more, which moves it by m, leaves about m² /
/// |point|. Where that is not far below rounding (m⁴ > (kLeft·|point|)²) the result is true, lane by lane, and the
/// tuple is for solve_normal_slowly(); those that belong together are not among them.
template <class V>
RPTV_DLT_INLINE auto solve_normal(const DltNormal<V>& normal, DltPoint<V>& out) noexcept {
  constexpr double kLeft = 1e-14;
  DltFactors<V> factors;
  factorise(normal, factors);
  Homogeneous<V> h;
  first_step(factors, h);
  const V start_x = h.x, start_y = h.y, start_z = h.z;  // w is 1
  V residual;
  next_step(factors, h, residual);
  const V square = h.x * h.x + h.y * h.y + h.z * h.z + h.w * h.w, both = 1.0 / (h.w * square);
  const V per_w = both * square, s2 = residual * (both * h.w), zero = s2 - s2;
  const V x = h.x * per_w, y = h.y * per_w, z = h.z * per_w;
  const V m_x = start_x - x, m_y = start_y - y, m_z = start_z - z, m2 = m_x * m_x + m_y * m_y + m_z * m_z;
  out.x = x, out.y = y, out.z = z;
  out.square = s2 > zero ? s2 : zero;  // rounding may leave less than nothing
  return m2 * m2 > kLeft * kLeft * (x * x + y * y + z * z);
}

/// Steps until they no longer move, of one tuple.
RPTV_HOST_DEVICE inline void solve_normal_slowly(const DltNormal<double>& normal, DltPoint<double>& out) noexcept {
  constexpr int kMostSteps = 100;
  constexpr double kMoved = 1e-13;  // of a vector of length 1
  DltFactors<double> factors;
  factorise(normal, factors);
  Homogeneous<double> h;
  first_step(factors, h);
  double moved = 1, square = 0, x = 0, y = 0, z = 0, w = 0;
  for (int step = 0; step < kMostSteps && moved > kMoved; ++step) {
    next_step(factors, h, square);
    const double length = sqrt(h.x * h.x + h.y * h.y + h.z * h.z + h.w * h.w), scale = copysign(1 / length, h.w);
    square *= scale * scale;
    h.x *= scale, h.y *= scale, h.z *= scale, h.w *= scale;
    moved = fabs(h.x - x) + fabs(h.y - y) + fabs(h.z - z) + fabs(h.w - w);
    x = h.x, y = h.y, z = h.z, w = h.w;
  }
  out.x = x / w, out.y = y / w, out.z = z / w, out.square = square < 0 ? 0 : square;
}

}  // namespace rptv
