// SPDX-License-Identifier: MIT
// A plano-convex lenslet as a prescription of two surfaces.
#include "simulation/lenslet_array.hpp"

#include <limits>
#include <numbers>

namespace rptv {

LensletArray::LensletArray(const LensletArraySettings& settings)
    : pitch_(settings.pitch_mm),
      focal_(settings.focal_length_mm),
      offset_x_(settings.offset_x_mm),
      offset_y_(settings.offset_y_mm),
      cos_(std::cos(settings.rotation_deg * std::numbers::pi / 180)),
      sin_(std::sin(settings.rotation_deg * std::numbers::pi / 180)) {
  if (settings.model != "plano_convex") return;
  Prescription lenslet;
  const double radius = (settings.index - 1) * focal_;  // eq. (10)
  lenslet.surfaces = {{radius, 0, settings.plate_thickness_mm, settings.index, 0}, {0, 0, 0, 1, 0}};
  refracting_.emplace(lenslet, 0, std::span<const Rim>{});
  // The front principal plane touches the vertices, the back one lies thickness/n before the plane.
  sensor_z_mm_ = settings.plate_thickness_mm * (1 - 1 / settings.index) + focal_;
}

std::array<double, 2> LensletArray::refracted(const ArrayRay& ray, std::array<double, 2> centre) const noexcept {
  const double scale = 1 / std::sqrt(1 + ray.slope_x * ray.slope_x + ray.slope_y * ray.slope_y);
  LensRay inside{ray.x_mm - centre[0], ray.y_mm - centre[1], 0, ray.slope_x * scale, ray.slope_y * scale, scale};
  constexpr double kLost = std::numeric_limits<double>::quiet_NaN();
  if (!refracting_->forward(inside)) return {kLost, kLost};
  const double length = (sensor_z_mm_ - inside.z) / inside.n;
  return {centre[0] + inside.x + length * inside.l, centre[1] + inside.y + length * inside.m};
}

}  // namespace rptv
