// SPDX-License-Identifier: MIT
// What a user can choose about multi-view reconstruction, with ranges; all of it fixed when the stage is built.
#pragma once

#include <string>
#include <vector>

#include "core/settings.hpp"
#include "reconstruct/detection/detector_settings.hpp"
#include "reconstruct/multi_view/iteration_settings.hpp"

namespace rptv {

/// Lengths are in the rig's frame.
struct MultiViewSettings {
  std::string method = "detections";  ///< "detections": once through the images; "iterative": dense scenes
  std::string rig;                    ///< path of the rig file
  std::vector<double> volume_x_mm;    ///< [from, to]; empty: what min_views cameras see together
  std::vector<double> volume_y_mm;    ///< the same
  std::vector<double> volume_z_mm;    ///< the same
  std::int64_t min_views = 3;         ///< that must see a particle
  double tolerance_px = 1;            ///< largest reprojection error of a particle, in every view
  double calibration_px = 0.05;       ///< rms error that the calibration adds to a detection, per axis
  std::string ghosts = "global";      ///< "global": the best choice of all; "rank": the seed's, in order of s
  double drift_alarm_px = 0.5;        ///< disparity of a camera that raises an alarm; 0: drift is not watched
  double drift_window_s = 60;         ///< over which disparities are averaged

  std::int64_t max_particles = 16384;
  std::int64_t max_matches = 65536;  ///< sets of detections that meet, before ghosts are removed
  std::int64_t threads = 0;          ///< at most one a camera; 0: as many as the machine has
  DetectorSettings detector;
  IterationSettings iterative;

  void fields(FieldList& list);
};

}  // namespace rptv
