// SPDX-License-Identifier: MIT
// Names, ranges and docs of the multi-view settings.
#include "reconstruct/multi_view/multi_view_settings.hpp"

namespace rptv {

void MultiViewSettings::fields(FieldList& list) {
  list.choice("method", method, {"detections", "iterative"},
              "once through the images; or their residuals searched again and again, for dense scenes");
  list.text("rig", rig, "rig file: the calibrated cameras, by the names that the source gives them");
  list.numbers("volume_x_mm", volume_x_mm, 0, -1e6, 1e6, "rig's frame, [from, to]; empty: what min_views cameras see");
  list.numbers("volume_y_mm", volume_y_mm, 0, -1e6, 1e6, "rig's frame, [from, to]; empty: what min_views cameras see");
  list.numbers("volume_z_mm", volume_z_mm, 0, -1e6, 1e6, "rig's frame, [from, to]; empty: what min_views cameras see");
  list.integer("min_views", min_views, 2, 16, "cameras that must see a particle");
  list.number("tolerance_px", tolerance_px, 0.01, 100, "largest reprojection error of a particle, in every view");
  list.number("calibration_px", calibration_px, 0, 100,
              "rms error that the calibration adds to a detection, per axis; it goes into the covariance");
  list.choice("ghosts", ghosts, {"global", "rank"},
              "each detection is one particle: the best choice of all together, or in order of the DLT's s");
  list.number("drift_alarm_px", drift_alarm_px, 0, 5,
              "a camera that sees particles so far from where the rig says raises a warning; 0: nobody looks; three "
              "cameras or more");
  list.number("drift_window_s", drift_window_s, 0.1, 86400, "over which disparities are averaged, s");
  list.integer("max_particles", max_particles, 1, 1000000, "particles in a frame; more are counted as overflow");
  list.integer("max_matches", max_matches, 1, 10000000,
               "sets of detections that meet in a frame, before ghosts are removed; more are counted as overflow");
  list.integer("threads", threads, 0, 1024,
               "that detect and match, at most one a camera; 0: as many as the machine has");
  list.section("detector", detector);
  list.section("iterative", iterative);
}

}  // namespace rptv
