// SPDX-License-Identifier: MIT
// Where two detections say that a third view sees the particle: a box along that view's epipolar line.
#pragma once

#include <algorithm>
#include <cmath>

#include "reconstruct/multi_view/epipolar_kernel.hpp"

namespace rptv {

inline constexpr double kScaleSlack = 1.15;     ///< scales vary over the volume by less
inline constexpr double kNoWander_px = 0.01;    ///< less is not worth a look at the rays
inline constexpr double kMostAlong = 32;        ///< tolerances, where two views hardly fix a depth
inline constexpr std::size_t kMostHits = 8;     ///< in one view, near one place
inline constexpr std::size_t kEnoughViews = 6;  ///< of a good set that settles its detections

/// Largest distance from an epipolar line, px, of a detection of a view of `px_per_mm`: both views may be wrong by the
/// tolerance.
RPTV_HOST_DEVICE inline double across_px(double tolerance_px, double px_per_mm, double first_px_per_mm) noexcept {
  return tolerance_px * (1 + px_per_mm * (kScaleSlack / first_px_per_mm));
}

/// How wrong the depth may be, mm, that a detection `error_px` from the line gives, which is at `at`.
RPTV_HOST_DEVICE inline double depth_error_mm(double error_px, const EpipolarLine::Place& at) noexcept {
  return error_px / std::sqrt(at.du * at.du + at.dv * at.dv);
}

struct AskedPlace {
  double u, v;            ///< the middle, px
  double line_u, line_v;  ///< direction of the line
  double along_px, across_px;

  /// `at`: the depth's image in this view. The depth is as wrong as the first two views may be.
  RPTV_HOST_DEVICE AskedPlace(const EpipolarLine::Place& at, double tolerance_px, double error_px,
                              double depth_error_mm) noexcept
      : u(at.u), v(at.v), across_px(error_px) {
    const double fast = std::sqrt(at.du * at.du + at.dv * at.dv) + 1e-9;
    line_u = at.du / fast, line_v = at.dv / fast;
    along_px = std::min(error_px + fast * depth_error_mm, kMostAlong * tolerance_px);
  }
  /// Half-widths of a box with sides along u and v that holds all of it.
  RPTV_HOST_DEVICE double reach_u() const noexcept {
    return std::abs(line_u) * along_px + std::abs(line_v) * across_px;
  }
  RPTV_HOST_DEVICE double reach_v() const noexcept {
    return std::abs(line_v) * along_px + std::abs(line_u) * across_px;
  }
  RPTV_HOST_DEVICE bool holds(double off_u, double off_v) const noexcept {
    return std::abs(off_u * line_v - off_v * line_u) <= across_px &&
           std::abs(off_u * line_u + off_v * line_v) <= along_px;
  }
};

}  // namespace rptv
