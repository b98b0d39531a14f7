// SPDX-License-Identifier: MIT
// How probable it is that a set of detections meets by chance: the ghost column of multi-view particles.
#pragma once

#include "reconstruct/multi_view/correspondence.hpp"

namespace rptv {

/// Of one frame. A ray meets so many detections of another view by chance (pairs a search, true ones included: an upper
/// bound); each further view has one in the searched place with probability density·area; and of all that pass the
/// tolerance, a share (squared error / largest)^(degrees of freedom / 2) is as good as this one, as the errors of a
/// chance match are spread evenly. With λ the product, λ / (1 + λ) is the probability, if half of all such sets are
/// true.
class ChanceOfMatch {
 public:
  /// `counts`: rays followed in the frame, and pairs.
  ChanceOfMatch(std::span<const SeenView> views, const CorrespondenceCounts& counts, double tolerance_px) noexcept;
  double of(const ViewMatch& match) const noexcept;

 private:
  double tolerance_px_, pairs_;
  std::array<double, kMaxViews> in_view_{};  ///< chance of a detection in a searched place
};

}  // namespace rptv
