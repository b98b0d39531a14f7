// SPDX-License-Identifier: MIT
// The DLT of eq. (4) for one tuple of views, or for several in the lanes of V: 4×4 normal matrix, LDLᵀ, inverse
// iteration.
#pragma once

#include "reconstruct/host_device.hpp"

/// A file that compiles this for an instruction set of its own puts that target's attribute here first: vector types
/// that are wider than the default target's would otherwise be cut up before they are inlined.
#ifndef RPTV_DLT_TARGET
#define RPTV_DLT_TARGET
#endif
#define RPTV_DLT_INLINE RPTV_DLT_TARGET [[gnu::always_inline]] RPTV_HOST_DEVICE inline

namespace rptv {

/// AᵀA, upper triangle.
template <class V>
struct DltNormal {
  V m00{}, m01{}, m02{}, m03{}, m11{}, m12{}, m13{}, m22{}, m23{}, m33{};
};

/// Adds one row (a, b, c, d) of A.
template <class V>
RPTV_DLT_INLINE void add_row(DltNormal<V>& m, const V& a, const V& b, const V& c, const V& d) noexcept {
  m.m00 += a * a, m.m01 += a * b, m.m02 += a * c, m.m03 += a * d;
  m.m11 += b * b, m.m12 += b * c, m.m13 += b * d;
  m.m22 += c * c, m.m23 += c * d;
  m.m33 += d * d;
}

/// A homogeneous point: (x, y, z) / w.
template <class V>
struct Homogeneous {
  V x, y, z, w;
};

/// L of AᵀA = L·D·Lᵀ, and D's last entry over each of the others: inverse iteration needs D⁻¹ only up to a factor, and
/// this one stays finite when the rays meet exactly (D's last entry is 0) and keeps the iterates' length near 1.
template <class V>
struct DltFactors {
  V l10, l20, l30, l21, l31, l32, q0, q1, q2, d3;
};

template <class V>
RPTV_DLT_INLINE void factorise(const DltNormal<V>& m, DltFactors<V>& f) noexcept {
  const V i0 = 1.0 / m.m00;
  f.l10 = m.m01 * i0, f.l20 = m.m02 * i0, f.l30 = m.m03 * i0;
  const V i1 = 1.0 / (m.m11 - f.l10 * m.m01);
  const V a21 = m.m12 - f.l10 * m.m02, a31 = m.m13 - f.l10 * m.m03;
  f.l21 = a21 * i1, f.l31 = a31 * i1;
  const V i2 = 1.0 / (m.m22 - f.l20 * m.m02 - f.l21 * a21);
  const V a32 = m.m23 - f.l20 * m.m03 - f.l21 * a31;
  f.l32 = a32 * i2;
  f.d3 = m.m33 - f.l30 * m.m03 - f.l31 * a31 - f.l32 * a32;
  f.q0 = f.d3 * i0, f.q1 = f.d3 * i1, f.q2 = f.d3 * i2;
}

/// The first step of inverse iteration, from (0, 0, 0, 1): the least-squares point.
template <class V>
RPTV_DLT_INLINE void first_step(const DltFactors<V>& f, Homogeneous<V>& h) noexcept {
  h.w = 1.0 + (f.l32 - f.l32);
  h.z = -f.l32;
  h.y = -f.l31 - f.l21 * h.z;
  h.x = -f.l30 - f.l20 * h.z - f.l10 * h.y;
}

/// One more: towards the eigenvector of the smallest eigenvalue, s². Gives hᵀ·AᵀA·h of the new h, too, which costs
/// little here: Lᵀ·h is what lies between the two substitutions. Rounding leaves it some 1e-16 of AᵀA's last entry.
template <class V>
RPTV_DLT_INLINE void next_step(const DltFactors<V>& f, Homogeneous<V>& h, V& square) noexcept {
  const V x = h.x, y = h.y - f.l10 * x;
  const V z = h.z - f.l20 * x - f.l21 * y;
  const V w = h.w - f.l30 * x - f.l31 * y - f.l32 * z;
  const V qx = f.q0 * x, qy = f.q1 * y, qz = f.q2 * z;
  square = f.d3 * (w * w + (qx * x + qy * y + qz * z));
  h.w = w;
  h.z = qz - f.l32 * h.w;
  h.y = qy - f.l21 * h.z - f.l31 * h.w;
  h.x = qx - f.l10 * h.y - f.l20 * h.z - f.l30 * h.w;
}

}  // namespace rptv
