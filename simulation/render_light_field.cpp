// SPDX-License-Identifier: MIT
// Rays through main lens and lenslet to the sensor, and diffraction.
#include "simulation/render_light_field.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rptv {

namespace {

constexpr int kOffsets = 32;  // sub-pixel positions of the diffraction kernel
// Streams of random numbers: above the frame number.
constexpr std::uint64_t kRayStream = std::uint64_t{1} << 56;
constexpr std::uint64_t kNoiseStream = std::uint64_t{2} << 56;
constexpr std::uint64_t kWhiteStream = std::uint64_t{3} << 56;
constexpr int kIntegrationSteps = 400;

/// sinc^2 of a square lenslet integrated over pixels, for light that falls `offset` px right of a pixel's centre.
void fill_kernel_row(double offset, double zero_px, int reach, float* row) {
  double sum = 0;
  for (int tap = -reach; tap <= reach; ++tap) {
    double value = 0;
    for (int step = 0; step < kIntegrationSteps; ++step) {
      const double x = tap - 0.5 + (step + 0.5) / kIntegrationSteps - offset;
      const double a = std::numbers::pi * x / zero_px;
      value += std::abs(a) < 1e-9 ? 1.0 : std::sin(a) * std::sin(a) / (a * a);
    }
    row[tap + reach] = static_cast<float>(value);
    sum += value;
  }
  for (int tap = 0; tap <= 2 * reach; ++tap) row[tap] = static_cast<float>(row[tap] / sum);
}

}  // namespace

LightFieldRenderer::LightFieldRenderer(const ScenarioSettings& scenario)
    : scenario_(scenario),
      optics_(scenario),
      shape_{static_cast<std::uint32_t>(scenario.camera.width_px),
             static_cast<std::uint32_t>(scenario.camera.height_px), scenario.camera.bits > 8 ? 2U : 1U},
      exposure_(scenario),
      samples_(particle_samples(static_cast<std::size_t>(scenario.rays_per_particle))),
      expected_(shape_.pixels()) {
  rays_.resize(samples_.size());
  landings_.resize(samples_.size());
  const auto& lenslets = scenario.lenslets;
  if (lenslets.diffraction)
    zero_px_ = lenslets.wavelength_nm * 1e-6 * lenslets.focal_length_mm / lenslets.pitch_mm /
               (scenario.camera.pixel_um * 1e-3);
  reach_px_ = lenslets.diffraction ? std::max(1, static_cast<int>(std::ceil(2.5 * zero_px_))) : 0;
  const auto taps = static_cast<std::size_t>(2 * reach_px_ + 1);
  kernel_.assign(kOffsets * taps, 1.0F);
  if (reach_px_ == 0) return;
  for (int i = 0; i < kOffsets; ++i)
    fill_kernel_row((i + 0.5) / kOffsets - 0.5, zero_px_, reach_px_, &kernel_[static_cast<std::size_t>(i) * taps]);
}

bool LightFieldRenderer::lands_inside(const SensorPoint& at) const noexcept {
  constexpr double kMargin = 0.5;  // a pixel from the border of the sensor
  return at.column >= kMargin && at.row >= kMargin && at.column <= shape_.width_px - 1.0 - kMargin &&
         at.row <= shape_.height_px - 1.0 - kMargin;
}

bool LightFieldRenderer::in_view(const Vector3& object) noexcept {
  const double radius = scenario_.seeding.particle_radius_um * 1e-3;
  if (optics_.lens().is_ideal())
    return optics_.fully_in_view(optics_.image_of(object), radius * optics_.magnification(object.z), 1.0);
  optics_.lens().trace(object, radius, samples_, 0, rays_);
  bool seen = false;
  optics_.lenslets().land(rays_, std::nullopt, landings_);
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    if (!(rays_[i].weight > 0)) continue;
    if (!lands_inside(optics_.sensor_point(landings_[i]))) return false;
    seen = true;
  }
  return seen;
}

void LightFieldRenderer::add_light(const SensorPoint& at, float photoelectrons) noexcept {
  if (!(std::abs(at.column) < 1e6 && std::abs(at.row) < 1e6)) return;  // a lost ray is not a number
  const int column = static_cast<int>(std::floor(at.column + 0.5)), row = static_cast<int>(std::floor(at.row + 0.5));
  const int width = static_cast<int>(shape_.width_px), height = static_cast<int>(shape_.height_px);
  if (column < -reach_px_ || row < -reach_px_ || column >= width + reach_px_ || row >= height + reach_px_) return;
  const int taps = 2 * reach_px_ + 1;
  const auto offset_of = [](double distance) {
    return std::clamp(static_cast<int>((distance + 0.5) * kOffsets), 0, kOffsets - 1);
  };
  const float* across = &kernel_[static_cast<std::size_t>(offset_of(at.column - column) * taps)];
  const float* down = &kernel_[static_cast<std::size_t>(offset_of(at.row - row) * taps)];
  const int first_tap = std::max(0, reach_px_ - column), last_tap = std::min(taps, width - column + reach_px_);
  for (int j = 0; j < taps; ++j) {
    const int y = row + j - reach_px_;
    if (y < 0 || y >= height) continue;
    float* line = expected_.data() + static_cast<std::ptrdiff_t>(y) * width + column - reach_px_;
    const float share = photoelectrons * down[j];
    for (int i = first_tap; i < last_tap; ++i) line[i] += share * across[i];
  }
}

void LightFieldRenderer::add_particle(const Vector3& object, double turn_rad) {
  const double body = scenario_.seeding.particle_radius_um * 1e-3;
  const double share =
      scenario_.seeding.photoelectrons * optics_.brightness(object.z) / static_cast<double>(samples_.size());
  TracerLight light{0, true};
  optics_.lens().trace(object, body, samples_, turn_rad, rays_);
  optics_.lenslets().land(rays_, std::nullopt, landings_);
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    const double weight = rays_[i].weight;
    if (!(weight > 0)) continue;
    const SensorPoint point = optics_.sensor_point(landings_[i]);
    add_light(point, static_cast<float>(share * weight));
    light.photoelectrons += share * weight;
    light.in_view = light.in_view && lands_inside(point);
  }
  if (optics_.lens().is_ideal())
    light.in_view = optics_.fully_in_view(optics_.image_of(object), body * optics_.magnification(object.z), 1.0);
  light.in_view = light.in_view && light.photoelectrons > 0;
  lights_.push_back(light);
}

void LightFieldRenderer::render(std::span<const Tracer> tracers, std::uint64_t frame, std::span<std::byte> pixels) {
  std::fill(expected_.begin(), expected_.end(), 0.0F);
  lights_.clear();
  Random random(static_cast<std::uint64_t>(scenario_.seed), kRayStream | frame);
  for (const auto& tracer : tracers)  // turned, so that no two particles share the quadrature's pattern
    add_particle(tracer.position, random.uniform(0, 2 * std::numbers::pi));
  exposure_.expose(expected_, kNoiseStream | frame, pixels);
}

void LightFieldRenderer::render_white(double peak, std::span<std::byte> pixels) {
  std::fill(expected_.begin(), expected_.end(), 0.0F);
  const auto& array = scenario_.lenslets;
  const double pixel_mm = scenario_.camera.pixel_um * 1e-3, pitch_px = array.pitch_mm / pixel_mm;
  const double radius_px = array.focal_length_mm * optics_.cone_slope() / pixel_mm;
  const double disc_px = std::max(1.0, std::numbers::pi * radius_px * radius_px);
  constexpr double kRaysPerSpot = 6, kFewestRays = 128, kMostRays = 4096;  // spot: a pixel, or diffraction's if larger
  const double spot_px = std::max(1.0, zero_px_ * zero_px_);
  const auto samples =
      lenslet_samples(static_cast<std::size_t>(std::clamp(kRaysPerSpot * disc_px / spot_px, kFewestRays, kMostRays)));
  std::vector<ArrayRay> rays(samples.size());
  std::vector<SensorMm> landings(samples.size());
  const double overlap = std::max(1.0, disc_px / (pitch_px * pitch_px));  // as many lenslets light a pixel
  const double share = peak * exposure_.full_well_e() * disc_px / overlap / static_cast<double>(samples.size());
  const double half_diagonal = 0.5 * scenario_.camera.pixel_um * 1e-3 * std::hypot(shape_.width_px, shape_.height_px);
  const long reach =
      std::lround((half_diagonal + std::hypot(array.offset_x_mm, array.offset_y_mm) + radius_px * pixel_mm) /
                  array.pitch_mm) +
      2;
  const double margin = pitch_px + radius_px;
  for (long v = -reach; v <= reach; ++v)
    for (long u = -reach; u <= reach; ++u) {
      const auto spot = optics_.white_spot({u, v});
      if (spot.column < -margin || spot.row < -margin || spot.column > shape_.width_px + margin ||
          spot.row > shape_.height_px + margin)
        continue;
      const auto centre = optics_.lenslet_centre({u, v});
      constexpr double kCell = 0.5;  // rays meet the disc inside the cell
      optics_.lens().white(centre[0], centre[1], kCell * array.pitch_mm, samples, rays);
      optics_.lenslets().land(rays, Lenslet{u, v}, landings);
      for (std::size_t i = 0; i < rays.size(); ++i)
        if (rays[i].weight > 0)
          add_light(optics_.sensor_point(landings[i]), static_cast<float>(share * rays[i].weight));
    }
  exposure_.expose(expected_, kWhiteStream, pixels);
}

}  // namespace rptv
