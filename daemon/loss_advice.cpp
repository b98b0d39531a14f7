// SPDX-License-Identifier: MIT
// The table of causes and settings.
#include "daemon/loss_advice.hpp"

namespace rptv {

std::string_view advice_on(LossCause cause) noexcept {
  switch (cause) {
    case LossCause::source_gap:
      return "look for an image that is missing in the recording, or packets that are lost";
    case LossCause::source_torn:
      return "look at cable, packet size and the camera's bandwidth";
    case LossCause::pool_empty:
      return "raise intake.pool_frames";
    case LossCause::superseded:
      return "it was slower than the source; a recording loses nothing with intake.policy = \"lossless\"";
    case LossCause::over_bound:
      return "raise intake.depth, or slow the source down";
    case LossCause::set_incomplete:
      return "another camera had no image of that instant; `rapidptv reconstruct` uses the views that are left";
    case LossCause::particle_overflow:
      return "raise max_particles of the reconstruction's section";
    case LossCause::track_overflow:
      return "raise linker.max_tracks";
    case LossCause::publish_backlog:
      return "raise publisher.queue_depth";
    case LossCause::linking_cut:
      return "raise linker.deadline_ms, or lower linker.search_range_mm";
    case LossCause::set_skew:
      return "raise sync.tolerance_us, or see why the cameras are out of step";
    case LossCause::frame_refused:
    case LossCause::view_refused:
      return "its images are missing, torn or of another size than the calibration's";
    case LossCause::too_few_views:
      return "lower multi_view.min_views, or see why images are missing";
    case LossCause::detection_overflow:
      return "raise multi_view.detector.threshold or multi_view.detector.max_detections";
    case LossCause::match_overflow:
      return "raise multi_view.max_matches, or lower the tolerance of matching (multi_view.tolerance_px, or "
             "multi_view.iterative.tolerance_px)";
    case LossCause::search_cut:
      return "raise multi_view.max_matches or multi_view.detector.threshold";
    case LossCause::ray_overflow:
      return "raise light_field.threshold or light_field.max_rays";
    case LossCause::candidate_overflow:
      return "raise light_field.min_count or light_field.max_candidates; iterative: multi_view.max_particles";
    default:
      return {};
  }
}

}  // namespace rptv
