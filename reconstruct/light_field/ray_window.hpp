// SPDX-License-Identifier: MIT
// Which lenslets can see a point: rays are sorted by lenslet, so their rays are a few runs in memory.
#pragma once

#include <algorithm>
#include <cmath>

#include "calibration/light_field/lenslet_lattice.hpp"
#include "reconstruct/light_field/n_ray_fit_kernel.hpp"
#include "reconstruct/light_field/rays.hpp"

namespace rptv {

/// A ray of lenslet c has slope -c/D + d with |d| ≤ the fan's half range, so rays that pass within `reach` of a point
/// at depth z come from c = (point ± (half range·|z| + reach))/(1 - z/D). Immutable; any thread.
class RayWindow {
 public:
  /// `lattice` must outlive this. `per_pupil_distance` is 1/D in 1/mm (0: telecentric).
  RayWindow(const LensletLattice& lattice, double per_pupil_distance, double slope_half_range)
      : lattice_(lattice), per_pupil_distance_(per_pupil_distance), slope_half_range_(slope_half_range) {}

  double slope_half_range() const noexcept { return slope_half_range_; }

  /// Calls visit(first, last) for runs [first, last) of ray numbers that contain every ray within `reach_mm` of
  /// `point`.
  template <class Visit>
  void visit(const Rays& rays, const ImagePoint& point, double reach_mm, const Visit& visit) const noexcept {
    const double shrink = 1 - point.z * per_pupil_distance_;
    if (!(shrink > 0)) return;
    const auto [u, v] = lattice_.on_true_lattice(point.x / shrink, point.y / shrink);
    const auto [half_u, half_v] = lattice_.reach((slope_half_range_ * std::abs(point.z) + reach_mm) / shrink);
    const double last_column = lattice_.columns() - 1.0, last_row = lattice_.rows() - 1.0;
    const double low_u = std::max(std::ceil(u - half_u), 0.0), high_u = std::min(std::floor(u + half_u), last_column);
    const double low_v = std::max(std::ceil(v - half_v), 0.0), high_v = std::min(std::floor(v + half_v), last_row);
    if (!(low_u <= high_u && low_v <= high_v)) return;
    for (auto row = static_cast<std::size_t>(low_v); row <= static_cast<std::size_t>(high_v); ++row) {
      const std::size_t start = row * lattice_.columns();
      const auto first = rays.first_of_lenslet[start + static_cast<std::size_t>(low_u)];
      const auto last = rays.first_of_lenslet[start + static_cast<std::size_t>(high_u) + 1];
      if (first < last) visit(first, last);
    }
  }

 private:
  const LensletLattice& lattice_;
  const double per_pupil_distance_, slope_half_range_;
};

}  // namespace rptv
