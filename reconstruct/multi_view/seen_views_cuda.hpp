// SPDX-License-Identifier: MIT
// What the views of a rig saw in a frame set, as it lies on the device.
#pragma once

#include <cstdint>

#include "reconstruct/cuda_bins.hpp"
#include "reconstruct/multi_view/seen_ray_kernel.hpp"

namespace rptv {

/// One view's detections, as SeenView has them; device memory.
struct CudaSeen {
  const SeenRay* ray;
  const double *u, *v;           ///< in the view's pinhole image, px; not a number: unusable
  const std::uint32_t* settled;  ///< not 0: leave this detection alone
  std::uint32_t count;           ///< detections
};

/// 128×128 cells of equal size over a view's pinhole image; what is beyond is in the outer ones.
struct CellOf {
  static constexpr std::uint32_t kAcross = 128, kCells = kAcross * kAcross;
  double from_u, from_v, per_u, per_v;

  RPTV_HOST_DEVICE static std::uint32_t clamped(double cell) noexcept {
    if (!(cell > 0)) return 0;
    return cell < kAcross ? static_cast<std::uint32_t>(cell) : kAcross - 1;
  }
  RPTV_HOST_DEVICE std::uint32_t row(double v) const noexcept { return clamped((v - from_v) * per_v); }
  RPTV_HOST_DEVICE std::uint32_t column(double u) const noexcept { return clamped((u - from_u) * per_u); }
  RPTV_HOST_DEVICE std::uint32_t operator()(double u, double v) const noexcept { return row(v) * kAcross + column(u); }
};

/// What does not change of a view: ViewRays' numbers.
struct CudaViewGeometry {
  Matrix3 axes;
  Projection pinhole;
  double px_per_mm;
  double wander_px;
  CellOf cell;
};

/// All views; device memory. Of view v's detection d: [v·max_detections + d]; of view v's cells: those from
/// cell_start[v·(CellOf::kCells + 2)] on.
struct CudaViews {
  const CudaViewGeometry* geometry;
  SeenRay* ray;
  double *u, *v;
  double* rows;  ///< eight a detection, as DltRowPair lies in memory
  std::uint32_t* settled;
  std::uint32_t *cell_start, *cell, *cell_entry;
  std::uint32_t max_detections, views;

  RPTV_HOST_DEVICE CudaSeen seen(std::uint32_t view, std::uint32_t count) const noexcept {
    const std::size_t first = std::size_t{view} * max_detections;
    return {ray + first, u + first, v + first, settled + first, count};
  }
  RPTV_HOST_DEVICE CudaBins cells(std::uint32_t view) const noexcept {
    const std::size_t first = std::size_t{view} * max_detections;
    return {cell_start + std::size_t{view} * (CellOf::kCells + 2), cell + first, cell_entry + first};
  }
};

}  // namespace rptv
