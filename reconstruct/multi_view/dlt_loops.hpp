// SPDX-License-Identifier: MIT
// The loop behind dlt.hpp, compiled for several instruction sets: V is the vector of doubles that they have.
#pragma once

#include <cstdint>

#include "reconstruct/multi_view/dlt.hpp"
#include "reconstruct/multi_view/dlt_kernel.hpp"

namespace rptv {

/// Solves one tuple by as many steps as it takes.
void solve_slowly(std::span<const DltRow> rows, std::size_t lane, DltSolutions& out) noexcept;

#if defined(__x86_64__)
void solve_dlt_avx2(std::span<const DltRow> rows, DltSolutions& out) noexcept;
void solve_dlt_avx512(std::span<const DltRow> rows, DltSolutions& out) noexcept;
#endif

template <class V>
RPTV_DLT_INLINE void load(const std::array<double, kDltLanes>& from, std::size_t lane, V& to) noexcept {
  __builtin_memcpy(&to, from.data() + lane, sizeof(V));
}

template <class V, std::size_t kRows>
RPTV_DLT_INLINE void sum_rows(std::span<const DltRow, kRows> rows, std::size_t lane, DltNormal<V>& normal) noexcept {
  for (const auto& row : rows) {
    V a, b, c, d;
    load(row.coefficient[0], lane, a), load(row.coefficient[1], lane, b);
    load(row.coefficient[2], lane, c), load(row.coefficient[3], lane, d);
    add_row(normal, a, b, c, d);
  }
}

/// A step from distance e (of the unit of A's columns) ends at e·r, r = (s / next singular value)², and the
/// least-squares point is already |point|·r from the solution: one step more, which moves it by m, leaves about m² /
/// |point|. Tuples where that is not far below rounding are solved slowly; those that belong together are not among
/// them.
template <class V, std::size_t kRows>
RPTV_DLT_INLINE void solve_dlt_rows(std::span<const DltRow, kRows> rows, DltSolutions& out) noexcept {
  constexpr double kLeft = 1e-14;
  alignas(64) std::int64_t slow[kDltLanes];  // not 0 where m⁴ > (kLeft·|point|)²
  for (std::size_t lane = 0; lane < kDltLanes; lane += sizeof(V) / sizeof(double)) {
    DltNormal<V> normal;
    sum_rows(rows, lane, normal);
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
    const auto far = m2 * m2 > kLeft * kLeft * (x * x + y * y + z * z);
    const V positive = s2 > zero ? s2 : zero;  // rounding may leave less than nothing
    __builtin_memcpy(out.x.data() + lane, &x, sizeof(V)), __builtin_memcpy(out.y.data() + lane, &y, sizeof(V));
    __builtin_memcpy(out.z.data() + lane, &z, sizeof(V)), __builtin_memcpy(out.s.data() + lane, &positive, sizeof(V));
    __builtin_memcpy(slow + lane, &far, sizeof(V));
  }
  std::int64_t any = 0;
  for (std::size_t lane = 0; lane < kDltLanes; ++lane) any |= slow[lane];
  for (std::size_t lane = 0; lane < kDltLanes; ++lane) out.s[lane] = __builtin_sqrt(out.s[lane]);
  if (any == 0) return;
  for (std::size_t lane = 0; lane < kDltLanes; ++lane)
    if (slow[lane] != 0) solve_slowly(rows, lane, out);
}

/// Three and four views are what most rigs have: known counts of rows make straight code.
template <class V>
RPTV_DLT_INLINE void solve_dlt_lanes(std::span<const DltRow> rows, DltSolutions& out) noexcept {
  if (rows.size() == 8) return solve_dlt_rows<V>(rows.first<8>(), out);
  if (rows.size() == 6) return solve_dlt_rows<V>(rows.first<6>(), out);
  solve_dlt_rows<V>(rows, out);
}

}  // namespace rptv
