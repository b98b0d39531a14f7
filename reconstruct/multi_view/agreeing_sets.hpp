// SPDX-License-Identifier: MIT
// Of sets of detections that may be particles, those whose disparities agree in all cameras at once.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "calibration/space.hpp"
#include "reconstruct/multi_view/view_match.hpp"

namespace rptv {

/// One set: where its rays meet (rig's frame) and its projections less its detections.
struct SetDisparities {
  Point3 at_mm{};
  std::uint32_t views = 0;  ///< bit by bit
  std::array<std::array<float, 2>, kMaxViews> px{};
};

/// Sets of one part of the volume: true ones have about the same disparities in each camera, those of chance differ in
/// all of them (five numbers for four cameras, where a camera's own map has two). Brings to the front, and returns,
/// the sets within a third of `radius_px` (0.8 px at least) in every view of the place where most agree; none when no
/// more agree there than by chance. The order of the others changes. Looks at the first kMostTried for the place.
/// Set-up only.
inline constexpr std::size_t kMostTried = 2048;
std::span<const SetDisparities> agreeing_sets(std::span<SetDisparities> sets, double radius_px);

}  // namespace rptv
