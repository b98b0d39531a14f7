// SPDX-License-Identifier: MIT
// Densities of a frame's detections, and what they make of a match.
#include "reconstruct/multi_view/chance_of_match.hpp"

#include <algorithm>
#include <cmath>

namespace rptv {

ChanceOfMatch::ChanceOfMatch(const Correspondence& correspondence, double tolerance_px) noexcept
    : tolerance_px_(tolerance_px) {
  const double edge = 4 * tolerance_px;  // of the place that two views leave, where the scales are alike
  const auto& counts = correspondence.counts();
  pairs_ = static_cast<double>(counts.pairs) / static_cast<double>(std::max<std::size_t>(counts.rays, 1));
  for (std::size_t v = 0; v < correspondence.views().size(); ++v) {
    const auto& [left, top, right, bottom] = correspondence.views()[v].rays().pinhole_range();
    in_view_[v] = std::min(
        1.0, static_cast<double>(correspondence.views()[v].size()) / ((right - left) * (bottom - top)) * edge * edge);
  }
}

double ChanceOfMatch::of(const ViewMatch& match) const noexcept {
  double chance = pairs_;
  std::uint32_t views = 0;
  for (std::size_t v = 0; v < in_view_.size(); ++v)
    if (match.tuple.detection[v] != kUnseen && ++views > 2) chance *= in_view_[v];
  const double share = std::min(match.square_px2 / (match.tuple.views * tolerance_px_ * tolerance_px_), 1.0);
  chance *= std::sqrt(share);  // to the power of views - 1.5 in all
  for (std::uint32_t v = 2; v < match.tuple.views; ++v) chance *= share;
  return chance / (1 + chance);
}

}  // namespace rptv
