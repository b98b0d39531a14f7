// SPDX-License-Identifier: MIT
// Poses of a rig's cameras from a rod of known length that is waved through the volume.
#pragma once

#include "calibration/cameras/bundle_adjust.hpp"
#include "calibration/cameras/rig.hpp"
#include "calibration/cameras/volume_accuracy.hpp"

namespace rptv {

struct WandCalibration {
  Rig rig;
  BundleResult result;
  std::size_t rods = 0;                  ///< views with both ends seen by two or more cameras
  double before_rms_mm = 0, rms_mm = 0;  ///< lengths as triangulated, against the known one
  double largest_mm = 0;
  VolumeAccuracy volume;  ///< where the rod was; lenses that were not fitted count as exact
};

/// `seen`: a target of two points, the rod's ends, seen in many views; its cameras are `start`'s, in that order. Poses,
/// and with `fit_lenses` lenses too, are adjusted so that both ends fall where they were seen and all rods have
/// `length_mm`; the first camera stays where it is, and so do interfaces. `start` needs to be right to some per cent.
/// Throws Error(bad_data): fewer than 10 rods, a camera that sees fewer than 10 ends, or lengths that start 10 % off.
WandCalibration calibrate_with_wand(const Rig& start, const BoardSet& seen, double length_mm, bool fit_lenses);

}  // namespace rptv
