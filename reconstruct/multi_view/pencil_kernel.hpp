// SPDX-License-Identifier: MIT
// The coordinate of a pencil of epipolar lines, its bins, and what is near one of the lines.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "reconstruct/multi_view/epipolar_kernel.hpp"

namespace rptv {

class ViewRays;

/// The lines through the epipole (the first view's pinhole in the second's image), numbered by a coordinate that is
/// constant on each: the ratio of two of them. At the image's centre it is the distance across the lines in px.
struct PencilOfLines {
  Point3 across{}, along{};    ///< homogeneous lines through the epipole
  double least = 0, most = 0;  ///< coordinates in the image
  bool usable = false;         ///< false where the epipole is in the image, or near it: coordinates would not be finite

  PencilOfLines() = default;
  PencilOfLines(const ViewRays& first, const ViewRays& second) noexcept;
  RPTV_HOST_DEVICE double of(const Point3& homogeneous) const noexcept {
    return dot(across, homogeneous) / dot(along, homogeneous);
  }
  /// Times w / (along·homogeneous): how the coordinate changes per px across the lines.
  RPTV_HOST_DEVICE double change(double coordinate) const noexcept {
    const double u = across[0] - coordinate * along[0], v = across[1] - coordinate * along[1];
    return std::sqrt(u * u + v * v);
  }
};

/// As many bins as detections, one at least, of equal width in the coordinate; what is beyond is in the outer ones.
struct PencilBins {
  double least = 0, per_bin = 1;
  std::uint32_t bins = 1;

  PencilBins() = default;
  RPTV_HOST_DEVICE PencilBins(const PencilOfLines& lines, std::uint32_t detections) noexcept
      : least(lines.least), bins(detections > 0 ? detections : 1) {
    per_bin = static_cast<double>(bins) / (lines.most - lines.least);
  }
  RPTV_HOST_DEVICE std::uint32_t of(double coordinate) const noexcept {
    const double bin = (coordinate - least) * per_bin;
    if (!(bin > 0)) return 0;
    return bin < static_cast<double>(bins) ? static_cast<std::uint32_t>(bin) : bins - 1;
  }
};

/// One of the lines, for the detections within `reach_px` of it that are in its depths. With refraction the lines need
/// not go through the epipole: the range of coordinates is of the line's ends.
struct LineInPencil {
  double c, s, offset;  ///< |c·v - s·u - offset|: distance from the line, px
  double low, high;     ///< coordinates where such detections are
  double slack;         ///< in depth, at both ends
  std::size_t major;    ///< axis of the image that the line goes along

  /// The line is in front of the pinhole.
  RPTV_HOST_DEVICE LineInPencil(const PencilOfLines& lines, const EpipolarLine& line, const Sight& sight,
                                double reach_px) noexcept {
    const Point3 from = line.p + sight.near * line.q, to = line.p + sight.far * line.q;
    const double per_from = 1 / from[2], per_to = 1 / to[2];
    const double du = to[0] * per_to - from[0] * per_from, dv = to[1] * per_to - from[1] * per_from;
    major = std::abs(du) >= std::abs(dv) ? 0 : 1;
    const double per_px = 1 / std::sqrt(du * du + dv * dv + 1e-30);
    c = du * per_px, s = dv * per_px;
    offset = (c * from[1] - s * from[0]) * per_from;
    const double per_along_from = 1 / dot(lines.along, from), per_along_to = 1 / dot(lines.along, to);
    const double a = dot(lines.across, from) * per_along_from, b = dot(lines.across, to) * per_along_to;
    const double reach =
        reach_px * std::max(lines.change(a) * from[2] * per_along_from, lines.change(b) * to[2] * per_along_to);
    low = std::min(a, b) - reach, high = std::max(a, b) + reach;
    slack = reach_px * per_px * (sight.far - sight.near);
  }
  RPTV_HOST_DEVICE bool near(double u, double v, double reach_px) const noexcept {
    return std::abs(c * v - s * u - offset) <= reach_px;
  }
  RPTV_HOST_DEVICE bool in_depths(double t, const Sight& sight) const noexcept {
    return t >= sight.near - slack && t <= sight.far + slack;
  }
};

}  // namespace rptv
