// SPDX-License-Identifier: MIT
// What a calibration of several cameras by a target consists of: lenses, poses, walls.
#pragma once

#include <optional>
#include <vector>

#include "calibration/cameras/camera_model.hpp"

namespace rptv {

/// What there is to adjust. The first camera's pose stays as it is: it holds the frame.
struct Bundle {
  std::vector<CameraIntrinsics> lenses;            ///< of each camera
  std::vector<CameraPose> cameras;                 ///< rig → camera
  std::vector<std::optional<CameraPose>> targets;  ///< of each view, target → rig; none: the view is not used
  RefractiveStack stack;                           ///< that all look through, rig's frame; empty: air only
  /// Of each camera, in its own frame and moving with it; one without interfaces stands for `stack`. Empty: `stack`.
  /// Known: images hardly tell a window's distance and direction from the lens behind it.
  std::vector<RefractiveStack> windows;

  bool has_window(std::size_t camera) const { return !windows.empty() && !windows[camera].interfaces.empty(); }
};

/// What a camera looks through, in the rig's frame.
RefractiveStack stack_of(const Bundle& bundle, std::size_t camera);

/// The bundle in another frame: x_now = frame.rotation·x_new + frame.translation.
Bundle in_frame(const Bundle& bundle, const CameraPose& frame);

}  // namespace rptv
