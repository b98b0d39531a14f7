// SPDX-License-Identifier: MIT
// The arithmetic of which lenslets can see a point. Host and device.
#pragma once

#include <cmath>
#include <cstdint>

#include "calibration/light_field/lattice_inverse.hpp"
#include "reconstruct/light_field/n_ray_fit_kernel.hpp"

namespace rptv {

/// Lenslets of a block of the lattice: rows first_row … end_row - 1, of which the columns first_column … last_column.
struct LensletBlock {
  std::uint32_t first_row, end_row, first_column, last_column;
};

/// A ray of lenslet c has slope -c/D + d with |d| ≤ the fan's half range, so rays that pass within `reach` of a point
/// at depth z come from c = (point ± (half range·|z| + reach))/(1 - z/D).
struct RayWindowKernel {
  LatticeInverse lattice;
  double first_u, first_v;             ///< lattice numbers of lenslet 0
  double columns_per_mm, rows_per_mm;  ///< that a reach along x and y spans at most
  double per_pupil_distance;           ///< 1/D, 1/mm; 0: telecentric
  double slope_half_range;
  std::uint32_t columns, rows;

  /// No rows where nothing sees it.
  RPTV_HOST_DEVICE LensletBlock block_near(const ImagePoint& point, double reach_mm) const noexcept {
    const double shrink = 1 - point.z * per_pupil_distance;
    if (!(shrink > 0)) return {};
    const auto at = lattice.lattice_of(point.x / shrink, point.y / shrink);
    const double u = at[0] - first_u, v = at[1] - first_v;
    const double aside = (slope_half_range * fabs(point.z) + reach_mm) / shrink;
    const double half_u = aside * columns_per_mm, half_v = aside * rows_per_mm;
    const double low_u = at_least_0(ceil(u - half_u)), high_u = at_most(floor(u + half_u), columns - 1.0);
    const double low_v = at_least_0(ceil(v - half_v)), high_v = at_most(floor(v + half_v), rows - 1.0);
    if (!(low_u <= high_u && low_v <= high_v)) return {};
    return {static_cast<std::uint32_t>(low_v), static_cast<std::uint32_t>(high_v) + 1,
            static_cast<std::uint32_t>(low_u), static_cast<std::uint32_t>(high_u)};
  }
  RPTV_HOST_DEVICE std::uint32_t first_lenslet(const LensletBlock& block, std::uint32_t row) const noexcept {
    return row * columns + block.first_column;
  }
  RPTV_HOST_DEVICE std::uint32_t last_lenslet(const LensletBlock& block, std::uint32_t row) const noexcept {
    return row * columns + block.last_column;
  }

 private:
  RPTV_HOST_DEVICE static double at_least_0(double value) noexcept { return value < 0 ? 0 : value; }
  RPTV_HOST_DEVICE static double at_most(double value, double limit) noexcept { return limit < value ? limit : value; }
};

}  // namespace rptv
