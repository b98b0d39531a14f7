// SPDX-License-Identifier: MIT
// Convergence of real rays, spots and the view of the sensor.
#include "simulation/optics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/quadrature.hpp"

namespace rptv {

namespace {
constexpr std::size_t kConvergenceRays = 400;
}

LightFieldOptics::LightFieldOptics(const ScenarioSettings& scenario)
    : scenario_(scenario),
      lens_(make_main_lens(scenario)),
      lenslets_(scenario.lenslets),
      pixel_mm_(scenario.camera.pixel_um * 1e-3),
      width_(static_cast<double>(scenario.camera.width_px)),
      height_(static_cast<double>(scenario.camera.height_px)) {}

double LightFieldOptics::brightness(double object_z_mm) const noexcept {
  return scenario_.seeding.equal_light ? 1.0 : lens_->first_order().brightness(object_z_mm);
}

std::optional<Vector3> LightFieldOptics::convergence(const Vector3& object) const {
  if (lens_->is_ideal()) return image_of(object);
  static const std::vector<RaySample> samples = lenslet_samples(kConvergenceRays);
  std::vector<ArrayRay> rays(samples.size());
  lens_->trace(object, 0, samples, 0, rays);
  double w = 0, x = 0, y = 0, sx = 0, sy = 0;
  int passed = 0;
  for (const ArrayRay& ray : rays) {
    if (!(ray.weight > 0)) continue;
    ++passed;
    w += ray.weight;
    x += ray.weight * ray.x_mm, y += ray.weight * ray.y_mm;
    sx += ray.weight * ray.slope_x, sy += ray.weight * ray.slope_y;
  }
  if (passed < 3) return std::nullopt;
  x /= w, y /= w, sx /= w, sy /= w;
  double covariance = 0, variance = 0;
  for (const ArrayRay& ray : rays) {
    if (!(ray.weight > 0)) continue;
    const double dx = ray.slope_x - sx, dy = ray.slope_y - sy;
    covariance += ray.weight * (dx * (ray.x_mm - x) + dy * (ray.y_mm - y));
    variance += ray.weight * (dx * dx + dy * dy);
  }
  if (!(variance > 0)) return std::nullopt;
  const double along = -covariance / variance;  // in the direction of the light
  return Vector3{x + sx * along, y + sy * along, -along};
}

SensorPoint LightFieldOptics::white_spot(Lenslet lenslet) const noexcept {
  const auto centre = lenslet_centre(lenslet);
  const double scale = exit_pupil_mm() > 0 ? 1.0 + scenario_.lenslets.focal_length_mm / exit_pupil_mm() : 1.0;
  return sensor_point({centre[0] * scale, centre[1] * scale});
}

bool LightFieldOptics::fully_in_view(const Vector3& image, double image_radius_mm, double margin_px) const noexcept {
  const double to_image = exit_pupil_mm() - image.z;
  const double f = scenario_.lenslets.focal_length_mm, pupil_radius = exit_pupil_radius_mm();
  const double chief = exit_pupil_mm() / to_image;
  const double blur = (pupil_radius * std::abs(image.z) + image_radius_mm * exit_pupil_mm()) / to_image;
  const double subimage = f * (pupil_radius + image_radius_mm) / to_image;
  const double reach = blur + subimage + scenario_.lenslets.pitch_mm * std::numbers::sqrt2 / 2 + margin_px * pixel_mm_;
  const double scale = chief + f / to_image;  // where the chief ray lands
  return std::abs(image.x) * scale + reach <= 0.5 * width_ * pixel_mm_ &&
         std::abs(image.y) * scale + reach <= 0.5 * height_ * pixel_mm_;
}

std::int64_t LightFieldOptics::particles_in_box() const noexcept {
  const auto& seeding = scenario_.seeding;
  if (!(seeding.per_lenslet > 0)) return seeding.particles;
  const double m = magnification(0) / scenario_.lenslets.pitch_mm;
  return std::max<std::int64_t>(1,
                                std::llround(seeding.per_lenslet * m * m * seeding.volume_x_mm * seeding.volume_y_mm));
}

LightFieldCalibration LightFieldOptics::calibration() const {
  const FirstOrder& lens = lens_->first_order();
  LightFieldCalibration calibration;
  calibration.sensor.width_px = scenario_.camera.width_px;
  calibration.sensor.height_px = scenario_.camera.height_px;
  calibration.sensor.pixel_um = scenario_.camera.pixel_um;
  calibration.lenslets.pitch_um = scenario_.lenslets.pitch_mm * 1e3;
  calibration.lenslets.focal_length_mm = scenario_.lenslets.focal_length_mm;
  calibration.lenslets.rotation_deg = scenario_.lenslets.rotation_deg;
  calibration.lenslets.offset_um = {scenario_.lenslets.offset_x_mm * 1e3, scenario_.lenslets.offset_y_mm * 1e3};
  calibration.lens.exit_pupil_mm = lens.exit_pupil_mm;
  calibration.lens.image_f_number = 0.5 / lens.cone_slope;
  if (lens.efl_mm == 0) {
    calibration.lens.model = "telecentric";
    calibration.lens.magnification = lens.fixed_magnification;
    calibration.lens.medium_index = lens.medium_index;
  } else {
    calibration.lens.model = "thick_lens";
    calibration.lens.focal_length_mm = lens.efl_mm;
    calibration.lens.array_distance_mm = lens.array_distance_mm;
  }
  return calibration;
}

}  // namespace rptv
