// SPDX-License-Identifier: MIT
// OpenPTV's files, read number by number in liboptv's order and written so that nothing is lost.
#include "calibration/cameras/openptv_files.hpp"

#include <fmt/format.h>

#include <cmath>

#include "calibration/cameras/rig.hpp"
#include "calibration/number_text.hpp"

namespace rptv {

OpenptvCamera parse_openptv_ori(std::string_view ori, const std::string& origin) {
  NumberText text(ori, origin);
  OpenptvCamera camera;
  camera.position_mm = text.point("the camera's position (mm)");
  camera.angles_rad = text.point("omega, phi or kappa (rad)");
  for (int row = 0; row < 3; ++row) text.point("the rotation matrix");
  camera.xh_mm = text.number("xh (mm)");
  camera.yh_mm = text.number("yh (mm)");
  camera.cc_mm = text.number("the focal length (mm)");
  if (!(camera.cc_mm > 0)) text.refuse("the focal length", "is not above 0 mm; calibrate this camera");
  camera.glass_mm = text.point("the glass vector (mm)");
  return camera;
}

void parse_openptv_addpar(std::string_view addpar, const std::string& origin, OpenptvCamera& camera) {
  NumberText text(addpar, origin);
  camera.k1 = text.number("k1");
  camera.k2 = text.number("k2");
  camera.k3 = text.number("k3");
  camera.p1 = text.number("p1");
  camera.p2 = text.number("p2");
  camera.scale_x = text.number("scx");
  if (!(camera.scale_x > 0)) text.refuse("scx", "is not above 0; it is 1 where pixels are as ptv.par says");
  camera.shear_rad = text.number("she");
  if (!(std::cos(camera.shear_rad) > 0.1)) text.refuse("she", "is no small angle in rad; mend it");
}

OpenptvSetup parse_openptv_setup(std::string_view par, const std::string& origin) {
  NumberText text(par, origin);
  OpenptvSetup setup;
  const int cameras = text.integer("the number of cameras", 1, static_cast<int>(Rig::kMostCameras));
  for (int i = 0; i < cameras; ++i) {
    setup.images.emplace_back(text.word("a camera's image"));
    setup.calibration_images.emplace_back(text.word("a camera's calibration image"));
  }
  text.number("the high pass flag");
  text.number("the all-cameras flag");
  text.number("the TIFF flag");
  setup.width_px = text.integer("the images' width (px)", 1, 65536);
  setup.height_px = text.integer("the images' height (px)", 1, 65536);
  setup.pixel_x_mm = text.number("the pixels' width (mm)");
  if (!(setup.pixel_x_mm > 0)) text.refuse("the pixels' width", "is not above 0 mm; mend it");
  setup.pixel_y_mm = text.number("the pixels' height (mm)");
  if (!(setup.pixel_y_mm > 0)) text.refuse("the pixels' height", "is not above 0 mm; mend it");
  if (text.integer("chfield", 0, 2) != 0)
    text.refuse("chfield", "means interlaced fields, which are not supported; use whole frames (0)");
  setup.index_before = text.number("the refractive index before the glass");
  setup.index_glass = text.number("the refractive index of the glass");
  setup.index_behind = text.number("the refractive index behind the glass");
  setup.glass_mm = text.number("the thickness of the glass (mm)");
  if (!(setup.glass_mm >= 0)) text.refuse("the thickness of the glass", "is negative; give mm");
  return setup;
}

Matrix3 openptv_rotation(const Point3& angles_rad) {
  const double so = std::sin(angles_rad[0]), co = std::cos(angles_rad[0]);
  const double sp = std::sin(angles_rad[1]), cp = std::cos(angles_rad[1]);
  const double sk = std::sin(angles_rad[2]), ck = std::cos(angles_rad[2]);
  return {{{cp * ck, -cp * sk, sp},
           {co * sk + so * sp * ck, co * ck - so * sp * sk, -so * cp},
           {so * sk - co * sp * ck, so * ck + co * sp * sk, co * cp}}};
}

std::string openptv_ori(const OpenptvCamera& c) {
  const auto line = [](const Point3& p) { return fmt::format("{:.17g} {:.17g} {:.17g}\n", p[0], p[1], p[2]); };
  const Matrix3 rotation = openptv_rotation(c.angles_rad);
  return line(c.position_mm) + line(c.angles_rad) + "\n" + line(rotation[0]) + line(rotation[1]) + line(rotation[2]) +
         fmt::format("\n{:.17g} {:.17g}\n{:.17g}\n\n", c.xh_mm, c.yh_mm, c.cc_mm) + line(c.glass_mm);
}

std::string openptv_addpar(const OpenptvCamera& c) {
  return fmt::format("{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", c.k1, c.k2, c.k3, c.p1, c.p2,
                     c.scale_x, c.shear_rad);
}

std::string openptv_setup(const OpenptvSetup& s) {
  std::string text = fmt::format("{}\n", s.images.size());
  for (std::size_t i = 0; i < s.images.size(); ++i) text += s.images[i] + "\n" + s.calibration_images.at(i) + "\n";
  return text + fmt::format("0\n0\n1\n{}\n{}\n{:.17g}\n{:.17g}\n0\n{:.17g}\n{:.17g}\n{:.17g}\n{:.17g}\n", s.width_px,
                            s.height_px, s.pixel_x_mm, s.pixel_y_mm, s.index_before, s.index_glass, s.index_behind,
                            s.glass_mm);
}

}  // namespace rptv
