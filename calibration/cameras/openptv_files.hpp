// SPDX-License-Identifier: MIT
// The text files of OpenPTV that a rig consists of: .ori, .addpar and ptv.par, as liboptv reads and writes them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calibration/space.hpp"

namespace rptv {

/// One camera: its .ori file, and its .addpar file, whose absence means the defaults. Angles turn about x, y, z in this
/// order; the rotation matrix in the file is what they give, and liboptv reads past it.
struct OpenptvCamera {
  Point3 position_mm{};               ///< centre of projection
  Point3 angles_rad{};                ///< omega, phi, kappa
  double xh_mm = 0, yh_mm = 0;        ///< optical axis from the image's centre: right, up
  double cc_mm = 0;                   ///< focal length
  Point3 glass_mm{};                  ///< normal to the glass, as long as its inner face is far from the origin
  double k1 = 0, k2 = 0, k3 = 0;      ///< radial distortion about the image's centre, mm^-2, mm^-4, mm^-6
  double p1 = 0, p2 = 0;              ///< decentring distortion, 1/mm
  double scale_x = 1, shear_rad = 0;  ///< scx, she
};

/// What ptv.par says about all cameras.
struct OpenptvSetup {
  std::vector<std::string> images;              ///< beginning of the images' names, one per camera
  std::vector<std::string> calibration_images;  ///< one per camera; .ori and .addpar are appended to each
  int width_px = 0, height_px = 0;
  double pixel_x_mm = 0, pixel_y_mm = 0;
  double index_before = 1, index_glass = 1, index_behind = 1;
  double glass_mm = 0;  ///< thickness
};

/// Errors (bad_data) name `origin`, line and value. The rotation matrix that the angles give, row by row: d in liboptv.
OpenptvCamera parse_openptv_ori(std::string_view ori, const std::string& origin);
void parse_openptv_addpar(std::string_view addpar, const std::string& origin, OpenptvCamera& camera);
OpenptvSetup parse_openptv_setup(std::string_view text, const std::string& origin);
Matrix3 openptv_rotation(const Point3& angles_rad);

/// The same as text, every number to the last bit.
std::string openptv_ori(const OpenptvCamera& camera);
std::string openptv_addpar(const OpenptvCamera& camera);
std::string openptv_setup(const OpenptvSetup& setup);

}  // namespace rptv
