// SPDX-License-Identifier: MIT
// One camera by itself: lens from its views of the target, and where the target stood in each.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/cameras/board_views.hpp"

namespace rptv {

/// Why a view was left out of the fit.
struct DroppedView {
  std::size_t camera = 0, view = 0;
  std::string reason;
};

/// Poses take the target's frame to the camera's: x_camera = rotation·x_target + translation.
struct SingleCamera {
  CameraIntrinsics lens;
  std::vector<std::optional<CameraPose>> target;  ///< of each view; none where it was not seen or was dropped
  std::vector<double> view_rms_px;                ///< root of the mean squared distance; 0 where dropped
  std::vector<DroppedView> dropped;
  double rms_px = 0;  ///< of all views kept
};

struct SingleCameraOptions {
  bool fit_k3 = false;        ///< sixth order of the radial distortion
  bool behind_glass = false;  ///< what is seen through interfaces fits no lens alone: a start, to some pixels
  bool drop_outliers = true;  ///< leave out views that fit several times worse than the others
};

/// Focal lengths, principal point and distortion (Zhang 2000, as OpenCV has it; a DLT starts targets that are not
/// flat). Throws Error(bad_data) that names the camera when its views cannot tell: too few, one orientation only, all
/// in one plane, residuals of many pixels. Set-up only.
SingleCamera fit_single_camera(const BoardSet& set, std::size_t camera, const SingleCameraOptions& options);

/// Pose of the target in an image of a known lens; none when the points do not fit one.
std::optional<CameraPose> target_pose(const CameraIntrinsics& lens, const std::vector<Point3>& target_mm,
                                      const std::vector<SeenPoint>& seen);

/// Root mean square distance of seen from projected points, px; infinite when one is not projected.
double rms_px(const CameraIntrinsics& lens, const CameraPose& pose, const std::vector<Point3>& target_mm,
              const std::vector<SeenPoint>& seen);

}  // namespace rptv
