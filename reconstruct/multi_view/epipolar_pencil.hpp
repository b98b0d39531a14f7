// SPDX-License-Identifier: MIT
// All epipolar lines of one view in another go through one point: detections sorted by which of those lines they are
// on.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "reconstruct/multi_view/epipolar.hpp"

namespace rptv {

/// The lines through the epipole (the first view's pinhole in the second's image), numbered by a coordinate that is
/// constant on each: the ratio of two of them. At the image's centre it is the distance across the lines in px.
struct PencilOfLines {
  Point3 across{}, along{};    ///< homogeneous lines through the epipole
  double least = 0, most = 0;  ///< coordinates in the image
  bool usable = false;         ///< false where the epipole is in the image, or near it: coordinates would not be finite

  PencilOfLines() = default;
  PencilOfLines(const ViewRays& first, const ViewRays& second) noexcept;
  double of(const Point3& homogeneous) const noexcept { return dot(across, homogeneous) / dot(along, homogeneous); }
  /// Times w / (along·homogeneous): how the coordinate changes per px across the lines.
  double change(double coordinate) const noexcept {
    const double u = across[0] - coordinate * along[0], v = across[1] - coordinate * along[1];
    return std::sqrt(u * u + v * v);
  }
};

/// One view's detections in order of the line. Takes memory for `capacity` detections at construction.
class EpipolarPencil {
 public:
  explicit EpipolarPencil(std::size_t capacity) : entry_(capacity), bin_(capacity), start_(capacity + 2) {}

  /// `lines` (usable) and `view` must outlive the searches. Allocates nothing.
  void build(const PencilOfLines& lines, const SeenView& view) noexcept;

  /// visit(detection, t) for those within `reach_px` of the line that are in the sight's depths; t as the place along
  /// the line says. With refraction the lines need not go through the epipole: the range is of the line's ends.
  template <class Visit>
  void visit_near(const EpipolarLine& line, const Sight& sight, double reach_px, const Visit& visit) const noexcept;

 private:
  struct Entry {
    double u, v;
    std::uint32_t number;
  };
  std::size_t bin_of(double coordinate) const noexcept {
    const double bin = (coordinate - lines_->least) * per_bin_;
    return bin > 0 ? std::min(static_cast<std::size_t>(bin), bins_ - 1) : 0;
  }

  const PencilOfLines* lines_ = nullptr;
  std::size_t bins_ = 1;
  double per_bin_ = 1;
  std::vector<Entry> entry_;
  std::vector<std::uint32_t> bin_, start_;
};

template <class Visit>
void EpipolarPencil::visit_near(const EpipolarLine& line, const Sight& sight, double reach_px,
                                const Visit& visit) const noexcept {
  if (!line.in_front(sight)) return;
  const Point3 from = line.p + sight.near * line.q, to = line.p + sight.far * line.q;
  const double per_from = 1 / from[2], per_to = 1 / to[2];
  const double du = to[0] * per_to - from[0] * per_from, dv = to[1] * per_to - from[1] * per_from;
  const std::size_t major = std::abs(du) >= std::abs(dv) ? 0 : 1;
  const double per_px = 1 / std::sqrt(du * du + dv * dv + 1e-30), c = du * per_px, s = dv * per_px;
  const double offset = (c * from[1] - s * from[0]) * per_from;
  const double per_along_from = 1 / dot(lines_->along, from), per_along_to = 1 / dot(lines_->along, to);
  const double a = dot(lines_->across, from) * per_along_from, b = dot(lines_->across, to) * per_along_to;
  const double reach =
      reach_px * std::max(lines_->change(a) * from[2] * per_along_from, lines_->change(b) * to[2] * per_along_to);
  const double low = std::min(a, b) - reach, high = std::max(a, b) + reach;
  const double slack = reach_px * per_px * (sight.far - sight.near);  // in depth, at both ends
  const std::uint32_t until = start_[bin_of(high) + 1];
  for (std::uint32_t i = start_[bin_of(low)]; i < until;) {
    // Which are near cannot be predicted: first listed without a branch, then looked at.
    std::array<std::uint32_t, 16> near;
    std::size_t count = 0;
    for (; i < until && count < near.size(); ++i) {
      near[count] = i;
      count += std::abs(c * entry_[i].v - s * entry_[i].u - offset) <= reach_px ? 1 : 0;
    }
    for (std::size_t k = 0; k < count; ++k) {
      const Entry& entry = entry_[near[k]];
      const double t = line.depth(major, major == 0 ? entry.u : entry.v);
      if (t >= sight.near - slack && t <= sight.far + slack) visit(entry.number, t);
    }
  }
}

}  // namespace rptv
