// SPDX-License-Identifier: MIT
// Cameras from calibration files that OpenCV's programs (and ROS) write: YAML, XML or JSON by cv::FileStorage.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibration/cameras/rig.hpp"

namespace rptv {

/// One camera from the text of such a file: camera_matrix (or cameraMatrix, K), distortion_coefficients (or distCoeffs,
/// dist_coeffs, D; k1 k2 p1 p2 [k3], more only when 0), image_width and image_height (or image_size), and optionally R
/// (or rvec) and T (or tvec), from the rig's frame to the camera's; without them the camera is the frame. One unit of T
/// is `unit_mm`. Throws Error(bad_data, configuration) with `origin` and the next step. Set-up only.
CameraModel parse_opencv_camera(const std::string& text, double unit_mm, const std::string& origin);

/// A rig of one file per camera, called like the files. Throws Error (no_input, bad_data, configuration).
Rig import_opencv(const std::vector<std::filesystem::path>& files, double unit_mm);

}  // namespace rptv
