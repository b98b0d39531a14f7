// SPDX-License-Identifier: MIT
// A lens whose distortion is about the image's centre, as some programs must have it, in place of one that is not.
#pragma once

#include "calibration/cameras/camera_model.hpp"

namespace rptv {

/// A lens, and how far at most it projects from the one that it stands for, px, within the image, when the camera is
/// rolled: (x, y) in its frame become (x cos - y sin, x sin + y cos).
struct CentredDistortion {
  CameraIntrinsics lens;
  double roll_rad = 0;
  double worst_px = 0;
};

/// The lens with its centre of distortion in the middle of the image that projects most like `lens`: exactly where
/// there is no distortion or the centre is there already, by least squares over a grid of pixels else. Set-up only.
CentredDistortion centred_distortion(const CameraIntrinsics& lens);

}  // namespace rptv
