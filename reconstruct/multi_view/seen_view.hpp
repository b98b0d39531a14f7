// SPDX-License-Identifier: MIT
// What one view saw in one frame, made ready for matching: rays, rows of the DLT, and an index of the pinhole image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calibration/space_algebra.hpp"
#include "reconstruct/detection/detections.hpp"
#include "reconstruct/multi_view/dlt.hpp"
#include "reconstruct/multi_view/strip_index.hpp"
#include "reconstruct/multi_view/view_rays.hpp"

namespace rptv {

/// Memory is taken at construction. One thread at a time.
class SeenView {
 public:
  /// `scale_mm` divides coordinates in rows(). `both`: across_v() is needed, too.
  SeenView(const ViewRays& rays, std::size_t capacity, double scale_mm, bool both = true);

  /// Takes a frame's detections; returns how many no light from the volume can have made, or for which is no room.
  std::size_t look(const Detections& seen) noexcept;

  const ViewRays& rays() const noexcept { return *rays_; }
  std::size_t size() const noexcept { return size_; }
  /// False for a detection that look() counted.
  bool usable(std::size_t i) const noexcept { return u_[i] == u_[i]; }
  /// Where its ray is in the pinhole image, px.
  double u(std::size_t i) const noexcept { return u_[i]; }
  double v(std::size_t i) const noexcept { return v_[i]; }
  const SeenRay& ray(std::size_t i) const noexcept { return ray_[i]; }
  /// Misses in px of the ray at depth 0, as rows of eq. (4) for (x, y, z) / scale_mm.
  const DltRowPair& rows(std::size_t i) const noexcept { return row_pair_[i]; }
  /// All of the last look(), for copies: size() each.
  const SeenRay* rays_begin() const noexcept { return ray_.data(); }
  const DltRowPair* rows_begin() const noexcept { return row_pair_.data(); }
  const double* u_begin() const noexcept { return u_.data(); }
  const double* v_begin() const noexcept { return v_.data(); }
  /// A point of the ray, and its direction per mm of depth, in the rig's axes, relative to the volume's centre.
  void sight(std::size_t i, Point3& from_mm, Point3& along) const noexcept;

  /// Points of the pinhole image: of strips that lie across u, and of strips that lie across v.
  const StripIndex& across_u() const noexcept { return across_u_; }
  const StripIndex& across_v() const noexcept { return across_v_; }

 private:
  const ViewRays* rays_;
  double scale_mm_;
  bool both_;
  std::size_t size_ = 0;
  std::vector<SeenRay> ray_;
  std::vector<DltRowPair> row_pair_;
  std::vector<double> u_, v_;
  StripIndex across_u_, across_v_;
};

}  // namespace rptv
