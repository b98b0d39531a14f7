// SPDX-License-Identifier: MIT
// First-order imaging, the thick lens by its cardinal planes, and the choice between the lens models.
#include "simulation/main_lens.hpp"

#include <cmath>

#include "simulation/aplanat.hpp"
#include "simulation/prescription_lens.hpp"

namespace rptv {

namespace {

/// Image distance behind H2 of an object at distance s in front of H1, eq. (8).
double conjugate(double efl_mm, double s_mm) { return 1.0 / (1.0 / efl_mm - 1.0 / s_mm); }

FirstOrder thick_lens_figures(const MainLensSettings& lens) {
  FirstOrder out;
  out.efl_mm = lens.efl_mm;
  out.focus_distance_mm = lens.magnification > 0 ? lens.efl_mm * (1 + 1 / lens.magnification) : lens.focus_distance_mm;
  out.array_distance_mm = conjugate(lens.efl_mm, out.focus_distance_mm);
  out.entrance_pupil_mm = out.focus_distance_mm + lens.entrance_pupil_mm;
  const double entrance_radius = 0.5 * lens.efl_mm / lens.f_number;
  if (std::abs(lens.entrance_pupil_mm) < 1e-9) {
    out.exit_pupil_mm = out.array_distance_mm;
    out.cone_slope = entrance_radius / out.exit_pupil_mm;
  } else {  // the exit pupil is the image of the entrance pupil, a virtual object behind H1
    const double behind_h2 = conjugate(lens.efl_mm, -lens.entrance_pupil_mm);
    out.exit_pupil_mm = out.array_distance_mm - behind_h2;
    out.cone_slope = entrance_radius * behind_h2 / lens.entrance_pupil_mm / out.exit_pupil_mm;
  }
  return out;
}

/// Ideal imaging: rays run from a point of the exit pupil through (towards) the image point.
class ThickLens : public MainLens {
 public:
  explicit ThickLens(const MainLensSettings& lens) : MainLens(thick_lens_figures(lens)) {}
  bool is_ideal() const noexcept override { return true; }

  void trace(const Vector3& object, double body_mm, std::span<const RaySample> samples, double turn_rad,
             std::span<ArrayRay> rays) const noexcept override {
    const double distance = first_order().exit_pupil_mm, pupil = first_order().cone_slope * distance;
    const Vector3 image = first_order().image_of(object);
    const double body = body_mm * first_order().magnification(object.z);
    const double stretch = distance / (distance - image.z);  // from the pupil to the image point, up to the array
    const double c = pupil * std::cos(turn_rad), s = pupil * std::sin(turn_rad), per_mm = 1 / distance;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const RaySample& sample = samples[i];
      const double px = c * sample.pupil_x - s * sample.pupil_y, py = s * sample.pupil_x + c * sample.pupil_y;
      const double dx = (image.x + body * sample.body_x - px) * stretch;
      const double dy = (image.y + body * sample.body_y - py) * stretch;
      rays[i] = {px + dx, py + dy, dx * per_mm, dy * per_mm, 1.0};
    }
  }

  void white(double x_mm, double y_mm, double reach_mm, std::span<const RaySample> samples,
             std::span<ArrayRay> rays) const noexcept override {
    const double distance = first_order().exit_pupil_mm, pupil = first_order().cone_slope * distance;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const RaySample& sample = samples[i];
      const double x = x_mm + reach_mm * sample.body_x, y = y_mm + reach_mm * sample.body_y;
      rays[i] = {x, y, (x - pupil * sample.pupil_x) / distance, (y - pupil * sample.pupil_y) / distance, 1.0};
    }
  }
};

}  // namespace

double FirstOrder::magnification(double object_z_mm) const noexcept {
  if (efl_mm == 0) return fixed_magnification;
  const double s = focus_distance_mm - object_z_mm;
  return conjugate(efl_mm, s) / s;
}

Vector3 FirstOrder::image_of(const Vector3& object) const noexcept {
  if (efl_mm == 0) {
    const double m = fixed_magnification;
    return {-m * object.x, -m * object.y, -m * m / medium_index * object.z};
  }
  const double s = focus_distance_mm - object.z;
  const double s_image = conjugate(efl_mm, s);
  const double m = s_image / s;
  return {-m * object.x, -m * object.y, array_distance_mm - s_image};
}

double FirstOrder::brightness(double object_z_mm) const noexcept {
  if (entrance_pupil_mm == 0) return 1;
  const double here = entrance_pupil_mm - object_z_mm;
  return entrance_pupil_mm * entrance_pupil_mm / (here * here);
}

std::shared_ptr<const MainLens> make_main_lens(const ScenarioSettings& scenario) {
  const auto& lens = scenario.main_lens;
  if (lens.model == "prescription") return std::make_shared<PrescriptionLens>(scenario);
  if (lens.model == "aplanat") return std::make_shared<Aplanat>(lens);
  return std::make_shared<ThickLens>(lens);
}

ScenarioSettings stopped_down(const ScenarioSettings& scenario, double share) {
  ScenarioSettings out = scenario;
  auto& lens = out.main_lens;
  lens.f_number /= share;
  lens.numerical_aperture *= share;
  if (lens.model == "prescription") lens.stop_radius_mm = share * PrescriptionLens(scenario).stop_radius_mm();
  return out;
}

}  // namespace rptv
