// SPDX-License-Identifier: MIT
// The loop behind dlt.hpp, compiled for several instruction sets: V is the vector of doubles that they have.
#pragma once

#include <cstdint>

#include "reconstruct/multi_view/dlt.hpp"
#include "reconstruct/multi_view/dlt_point_kernel.hpp"

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

template <class V>
RPTV_DLT_INLINE void store(const V& from, std::size_t lane, std::array<double, kDltLanes>& to) noexcept {
  __builtin_memcpy(to.data() + lane, &from, sizeof(V));
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

template <class V, std::size_t kRows>
RPTV_DLT_INLINE void solve_dlt_rows(std::span<const DltRow, kRows> rows, DltSolutions& out) noexcept {
  alignas(64) std::int64_t slow[kDltLanes];  // not 0 where solve_normal() says so
  for (std::size_t lane = 0; lane < kDltLanes; lane += sizeof(V) / sizeof(double)) {
    DltNormal<V> normal;
    sum_rows(rows, lane, normal);
    DltPoint<V> point;
    const auto far = solve_normal(normal, point);
    store(point.x, lane, out.x), store(point.y, lane, out.y);
    store(point.z, lane, out.z), store(point.square, lane, out.s);
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
