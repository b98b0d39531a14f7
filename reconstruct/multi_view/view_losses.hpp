// SPDX-License-Identifier: MIT
// What reconstruction from several views leaves out, as losses by cause.
#pragma once

#include "core/losses.hpp"
#include "reconstruct/multi_view/correspondence.hpp"
#include "reconstruct/multi_view/frame_gate.hpp"

namespace rptv {

/// The counts so far. `refused_detections`: particle images beyond their room.
inline void tell_view_losses(const FrameSetCounts& sets, const CorrespondenceCounts& matching,
                             std::uint64_t refused_detections, Losses& losses) noexcept {
  losses.set(LossCause::frame_refused, sets.refused_frames);
  losses.set(LossCause::view_refused, sets.refused_views);
  losses.set(LossCause::too_few_views, sets.too_few_views);
  losses.set(LossCause::detection_overflow, refused_detections);
  losses.set(LossCause::match_overflow, matching.refused_matches + matching.refused_hits);
  losses.set(LossCause::search_cut, matching.unsearched);
}

}  // namespace rptv
