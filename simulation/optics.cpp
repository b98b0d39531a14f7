// SPDX-License-Identifier: MIT
// Thick lens by its cardinal planes (eq. 8, 9), pupil imaged through it, lenslets with the sensor in their focal plane.
#include "simulation/optics.hpp"

#include <algorithm>
#include <numbers>

namespace rptv {

namespace {
/// Image distance behind H2 of an object at distance s in front of H1, eq. (8).
double conjugate(double efl_mm, double s_mm) { return 1.0 / (1.0 / efl_mm - 1.0 / s_mm); }
}  // namespace

LightFieldOptics::LightFieldOptics(const ScenarioSettings& scenario)
    : scenario_(scenario),
      pixel_mm_(scenario.camera.pixel_um * 1e-3),
      width_(static_cast<double>(scenario.camera.width_px)),
      height_(static_cast<double>(scenario.camera.height_px)) {
  const auto& lens = scenario.main_lens;
  array_distance_ = conjugate(lens.efl_mm, lens.focus_distance_mm);
  const double entrance_radius = 0.5 * lens.efl_mm / lens.f_number;
  if (std::abs(lens.entrance_pupil_mm) < 1e-9) {
    exit_pupil_ = array_distance_;
    pupil_radius_ = entrance_radius;
  } else {  // the exit pupil is the image of the entrance pupil, a virtual object behind H1
    const double behind_h2 = conjugate(lens.efl_mm, -lens.entrance_pupil_mm);
    exit_pupil_ = array_distance_ - behind_h2;
    pupil_radius_ = entrance_radius * behind_h2 / lens.entrance_pupil_mm;
  }
  const double angle = scenario.lenslets.rotation_deg * std::numbers::pi / 180.0;
  cos_ = std::cos(angle);
  sin_ = std::sin(angle);
}

double LightFieldOptics::magnification(double object_z_mm) const noexcept {
  const double s = scenario_.main_lens.focus_distance_mm - object_z_mm;
  return conjugate(scenario_.main_lens.efl_mm, s) / s;
}

Vector3 LightFieldOptics::image_of(const Vector3& object) const noexcept {
  const double s = scenario_.main_lens.focus_distance_mm - object.z;
  const double s_image = conjugate(scenario_.main_lens.efl_mm, s);
  const double m = s_image / s;
  return {-m * object.x, -m * object.y, array_distance_ - s_image};
}

double LightFieldOptics::brightness(double object_z_mm) const noexcept {
  const auto& lens = scenario_.main_lens;
  const double in_focus = lens.focus_distance_mm + lens.entrance_pupil_mm;
  const double here = in_focus - object_z_mm;
  return in_focus * in_focus / (here * here);
}

std::array<long, 2> LightFieldOptics::lenslet_at(double x_mm, double y_mm) const noexcept {
  const auto& array = scenario_.lenslets;
  const double x = (x_mm - array.offset_x_mm) / array.pitch_mm;
  const double y = (y_mm - array.offset_y_mm) / array.pitch_mm;
  return {std::lround(cos_ * x + sin_ * y), std::lround(-sin_ * x + cos_ * y)};
}

std::array<double, 2> LightFieldOptics::lenslet_centre(std::array<long, 2> lenslet) const noexcept {
  const auto& array = scenario_.lenslets;
  const auto u = static_cast<double>(lenslet[0]), v = static_cast<double>(lenslet[1]);
  return {array.offset_x_mm + array.pitch_mm * (cos_ * u - sin_ * v),
          array.offset_y_mm + array.pitch_mm * (sin_ * u + cos_ * v)};
}

SensorPoint LightFieldOptics::trace(const Vector3& image, double pupil_x_mm, double pupil_y_mm) const noexcept {
  const double stretch = exit_pupil_ / (exit_pupil_ - image.z);  // from the pupil to the image point, up to the array
  const double x = pupil_x_mm + (image.x - pupil_x_mm) * stretch;
  const double y = pupil_y_mm + (image.y - pupil_y_mm) * stretch;
  const auto centre = lenslet_centre(lenslet_at(x, y));
  const double reach = scenario_.lenslets.focal_length_mm / exit_pupil_;  // slope of the ray: (x - pupil) / exit_pupil
  return sensor_point(centre[0] + reach * (x - pupil_x_mm), centre[1] + reach * (y - pupil_y_mm));
}

SensorPoint LightFieldOptics::white_spot(std::array<long, 2> lenslet) const noexcept {
  const auto centre = lenslet_centre(lenslet);
  const double scale = 1.0 + scenario_.lenslets.focal_length_mm / exit_pupil_;
  return sensor_point(centre[0] * scale, centre[1] * scale);
}

bool LightFieldOptics::fully_in_view(const Vector3& image, double image_radius_mm, double margin_px) const noexcept {
  const double to_image = exit_pupil_ - image.z;
  const double f = scenario_.lenslets.focal_length_mm;
  const double chief = exit_pupil_ / to_image;
  const double blur = (pupil_radius_ * std::abs(image.z) + image_radius_mm * exit_pupil_) / to_image;
  const double subimage = f * (pupil_radius_ + image_radius_mm) / to_image;
  const double reach = blur + subimage + scenario_.lenslets.pitch_mm * std::numbers::sqrt2 / 2 + margin_px * pixel_mm_;
  const double scale = chief + f / to_image;  // where the chief ray lands
  return std::abs(image.x) * scale + reach <= 0.5 * width_ * pixel_mm_ &&
         std::abs(image.y) * scale + reach <= 0.5 * height_ * pixel_mm_;
}

LightFieldCalibration LightFieldOptics::calibration() const {
  LightFieldCalibration calibration;
  calibration.sensor.width_px = scenario_.camera.width_px;
  calibration.sensor.height_px = scenario_.camera.height_px;
  calibration.sensor.pixel_um = scenario_.camera.pixel_um;
  calibration.lenslets.pitch_um = scenario_.lenslets.pitch_mm * 1e3;
  calibration.lenslets.focal_length_mm = scenario_.lenslets.focal_length_mm;
  calibration.lenslets.rotation_deg = scenario_.lenslets.rotation_deg;
  calibration.lenslets.offset_um = {scenario_.lenslets.offset_x_mm * 1e3, scenario_.lenslets.offset_y_mm * 1e3};
  calibration.lens.model = "thick_lens";
  calibration.lens.exit_pupil_mm = exit_pupil_;
  calibration.lens.image_f_number = 0.5 * exit_pupil_ / pupil_radius_;
  calibration.lens.focal_length_mm = scenario_.main_lens.efl_mm;
  calibration.lens.array_distance_mm = array_distance_;
  return calibration;
}

}  // namespace rptv
