// SPDX-License-Identifier: MIT
// Rays of the ideal objective, in closed form.
#include "simulation/aplanat.hpp"

#include <cmath>

namespace rptv {

namespace {
FirstOrder figures(const MainLensSettings& lens) {
  FirstOrder out;
  out.fixed_magnification = lens.magnification;
  out.medium_index = lens.medium_index;
  const double sine = lens.numerical_aperture / lens.magnification;
  out.cone_slope = sine / std::sqrt(1 - sine * sine);
  return out;
}
}  // namespace

Aplanat::Aplanat(const MainLensSettings& lens)
    : MainLens(figures(lens)),
      aperture_(lens.numerical_aperture),
      magnification_(lens.magnification),
      index_(lens.medium_index),
      window_mm_(lens.window_mm) {
  const double edge = aperture_ * aperture_ / (index_ * index_);
  mean_weight_ = 2 * (1 - std::sqrt(1 - edge)) / edge;  // of 1/cos over a disc in the sine
}

void Aplanat::trace(const Vector3& object, double body_mm, std::span<const RaySample> samples, double turn_rad,
                    std::span<ArrayRay> rays) const noexcept {
  const double c = aperture_ * std::cos(turn_rad), s = aperture_ * std::sin(turn_rad);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const RaySample& sample = samples[i];
    const double sine_x = c * sample.pupil_x - s * sample.pupil_y, sine_y = s * sample.pupil_x + c * sample.pupil_y;
    const double sine2 = sine_x * sine_x + sine_y * sine_y;
    const double cos_air = std::sqrt(1 - sine2), cos_medium = std::sqrt(1 - sine2 / (index_ * index_));
    // up through the medium to the window, and back along the ray in air to the focal plane
    const double reach = (window_mm_ - object.z) / (index_ * cos_medium) - window_mm_ / (index_ * cos_air);
    const double x = object.x + body_mm * sample.body_x + reach * sine_x;
    const double y = object.y + body_mm * sample.body_y + reach * sine_y;
    const double slope = -1 / std::sqrt(magnification_ * magnification_ - sine2);
    rays[i] = {-magnification_ * x, -magnification_ * y, slope * sine_x, slope * sine_y,
               1 / (cos_medium * mean_weight_)};
  }
}

void Aplanat::white(double x_mm, double y_mm, double reach_mm, std::span<const RaySample> samples,
                    std::span<ArrayRay> rays) const noexcept {
  const double slope = first_order().cone_slope;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const RaySample& sample = samples[i];
    rays[i] = {x_mm + reach_mm * sample.body_x, y_mm + reach_mm * sample.body_y, slope * sample.pupil_x,
               slope * sample.pupil_y, 1.0};
  }
}

}  // namespace rptv
