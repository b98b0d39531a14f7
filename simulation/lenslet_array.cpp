// SPDX-License-Identifier: MIT
// A plano-convex lenslet as a prescription of two surfaces.
#include "simulation/lenslet_array.hpp"

#include <algorithm>
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

void LensletArray::land(std::span<const ArrayRay> rays, std::optional<Lenslet> lenslet,
                        std::span<SensorMm> at) const noexcept {
  for (std::size_t i = 0; i < rays.size(); ++i)
    at[i] = centre(lenslet ? *lenslet : this->at(rays[i].x_mm, rays[i].y_mm));
  if (refracting_) return refract(rays, at);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    at[i][0] += focal_ * rays[i].slope_x;
    at[i][1] += focal_ * rays[i].slope_y;
  }
}

/// `at` holds the centres of the rays' lenslets.
void LensletArray::refract(std::span<const ArrayRay> rays, std::span<SensorMm> at) const noexcept {
  constexpr std::size_t kBatch = 128;
  std::array<LensRay, kBatch> batch;
  for (std::size_t first = 0; first < rays.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, rays.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const ArrayRay& ray = rays[first + i];
      const SensorMm& middle = at[first + i];
      const double scale = 1 / std::sqrt(1 + ray.slope_x * ray.slope_x + ray.slope_y * ray.slope_y);
      batch[i] = {ray.x_mm - middle[0], ray.y_mm - middle[1], 0, ray.slope_x * scale, ray.slope_y * scale, scale};
    }
    refracting_->forward(std::span(batch).first(count));
    for (std::size_t i = 0; i < count; ++i) {
      const LensRay& ray = batch[i];
      const double length = (sensor_z_mm_ - ray.z) / ray.n;  // infinite when the ray is lost
      at[first + i][0] += ray.x + length * ray.l;
      at[first + i][1] += ray.y + length * ray.m;
    }
  }
}

}  // namespace rptv
