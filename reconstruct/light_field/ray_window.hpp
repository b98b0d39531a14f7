// SPDX-License-Identifier: MIT
// Which lenslets can see a point: rays are sorted by lenslet, so their rays are a few runs in memory.
#pragma once

#include <cstddef>

#include "calibration/light_field/lenslet_lattice.hpp"
#include "reconstruct/light_field/ray_window_kernel.hpp"
#include "reconstruct/light_field/rays.hpp"

namespace rptv {

/// The rays that may pass near a point, by RayWindowKernel. Immutable; any thread.
class RayWindow {
 public:
  /// `per_pupil_distance` is 1/D in 1/mm (0: telecentric).
  RayWindow(const LensletLattice& lattice, double per_pupil_distance, double slope_half_range)
      : kernel_{lattice.inverse(),  lattice.first()[0], lattice.first()[1], lattice.reach(1)[0], lattice.reach(1)[1],
                per_pupil_distance, slope_half_range,   lattice.columns(),  lattice.rows()} {}

  double slope_half_range() const noexcept { return kernel_.slope_half_range; }
  const RayWindowKernel& kernel() const noexcept { return kernel_; }

  /// Calls visit(first, last) for runs [first, last) of ray numbers that contain every ray within `reach_mm` of
  /// `point`.
  template <class Visit>
  void visit(const Rays& rays, const ImagePoint& point, double reach_mm, const Visit& visit) const noexcept {
    const LensletBlock block = kernel_.block_near(point, reach_mm);
    for (std::uint32_t row = block.first_row; row < block.end_row; ++row) {
      const std::size_t first = rays.first_of_lenslet[kernel_.first_lenslet(block, row)];
      const std::size_t last = rays.first_of_lenslet[kernel_.last_lenslet(block, row) + std::size_t{1}];
      if (first < last) visit(first, last);
    }
  }

 private:
  const RayWindowKernel kernel_;
};

}  // namespace rptv
