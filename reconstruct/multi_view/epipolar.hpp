// SPDX-License-Identifier: MIT
// The detections along an epipolar line, from an index of the image.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "reconstruct/multi_view/epipolar_kernel.hpp"
#include "reconstruct/multi_view/seen_view.hpp"

namespace rptv {

/// visit(detection, t) for those of a view within `reach_px` of the line; t as its place along the line says.
template <class Visit>
void visit_along(const SeenView& view, const EpipolarLine& line, const Sight& sight, double reach_px,
                 const Visit& visit) noexcept {
  if (!line.in_front(sight)) return;
  auto from = line.at(sight.near), to = line.at(sight.far);
  const double wide = to[0] - from[0], high = to[1] - from[1], length = std::hypot(wide, high);
  const std::size_t major = std::abs(wide) >= std::abs(high) ? 0 : 1;
  const double more = length > 0 ? reach_px / length : 0;  // beyond both ends
  const double reach = length > 0 ? reach_px * length / std::abs(major == 0 ? wide : high) : reach_px;
  from = {from[0] - more * wide, from[1] - more * high}, to = {to[0] + more * wide, to[1] + more * high};
  const StripIndex& index = major == 0 ? view.across_u() : view.across_v();
  index.along(from[major], from[1 - major], to[major], to[1 - major], reach, [&](const StripIndex::Point& point) {
    visit(point.number, std::clamp(line.depth(major, point.major), sight.near, sight.far));
  });
}

}  // namespace rptv
