// SPDX-License-Identifier: MIT
// Where the rays of several views meet, and how well: the DLT of eq. (3)-(4), eight tuples of views at once.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/instruction_set.hpp"

namespace rptv {

inline constexpr std::size_t kDltLanes = 8;

/// Row (a, b, c, d) of A in eq. (4), of eight tuples: coefficient[k][lane]. Two rows a view. A row of zeros is a view
/// that did not see the particle.
struct DltRow {
  alignas(64) std::array<std::array<double, kDltLanes>, 4> coefficient;
};

/// Solutions of eight tuples. (x, y, z) is the point of smallest |A·(x, y, z, 1)| / |(x, y, z, 1)|, and s that ratio,
/// A's smallest singular value. Units are the rows': with rows that give offsets in pixels and coordinates scaled by a
/// length well above the points', s is the root of the sum of squared reprojection errors, px. Rays that do not fix a
/// point (fewer than two, or parallel) give values that are not finite, or far away.
struct DltSolutions {
  alignas(64) std::array<double, kDltLanes> x, y, z, s;
};

/// Two rows of eq. (4) from a 3×4 projection matrix and a pixel, as the seed has them: v·p3 - p2 and p1 - u·p3.
using DltRowPair = std::array<std::array<double, 4>, 2>;
DltRowPair dlt_rows(const std::array<std::array<double, 4>, 3>& projection, double u_px, double v_px) noexcept;

/// Writes one tuple's two rows of one view into a lane of rows[0] and rows[1].
inline void put_rows(const DltRowPair& pair, std::size_t lane, DltRow* rows) noexcept {
  for (std::size_t r = 0; r < 2; ++r)
    for (std::size_t k = 0; k < 4; ++k) rows[r].coefficient[k][lane] = pair[r][k];
}

/// Solves eight tuples by the instruction set that it was made for; all sets give the same bits. Any thread.
class Dlt {
 public:
  /// The processor must have `set`.
  explicit Dlt(InstructionSet set = best_instruction_set()) noexcept;
  void operator()(std::span<const DltRow> rows, DltSolutions& out) const noexcept { solve_(rows, out); }

 private:
  void (*solve_)(std::span<const DltRow>, DltSolutions&) noexcept;
};

}  // namespace rptv
