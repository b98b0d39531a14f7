// SPDX-License-Identifier: MIT
// From views of a target to a calibrated rig, or a refusal that says why not.
#pragma once

#include <optional>
#include <vector>

#include "calibration/cameras/bundle_adjust.hpp"
#include "calibration/cameras/camera_graph.hpp"
#include "calibration/cameras/rig.hpp"
#include "calibration/cameras/single_camera.hpp"

namespace rptv {

struct CameraCalibrationOptions {
  SingleCameraOptions single;
  RefractiveStack stack;                  ///< interfaces in the first camera's frame; empty: the target stands in air
  std::vector<RefractiveStack> windows;   ///< of each camera, in its own frame, instead; as in Bundle
  bool fit_stack = false;                 ///< adjust where `stack` is
  std::optional<std::size_t> world_view;  ///< the rig's frame is the target's of this view; none: the first camera's
};

struct CameraCalibration {
  Rig rig;
  BundleResult result;  ///< in the rig's frame
  std::vector<SingleCamera> singles;
  CameraGraph graph;
  std::vector<DroppedView> dropped;
  BoardSet used;  ///< the set without what was dropped
};

/// Lenses one by one, pairs, the tree, then all together; images that the bundle cannot explain (several times the
/// median) are dropped and it is adjusted again. Throws Error(bad_data) as the steps do. Set-up only.
CameraCalibration calibrate_cameras(const BoardSet& set, const CameraCalibrationOptions& options);

/// Root mean square distance of every image of `set`, px; 0 where an image has no residuals.
std::vector<double> image_rms_px(const BoardSet& set, const BundleResult& result);

}  // namespace rptv
