// SPDX-License-Identifier: MIT
// Aiming of rays at the stop and their way through the surfaces.
#include "simulation/prescription_lens.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "simulation/shipped_file.hpp"

namespace rptv {

namespace {

constexpr std::size_t kBatch = 256;

FirstOrder figures_of(const LensAnalysis& lens, const MainLensSettings& settings) {
  const LensConjugates plane = settings.magnification > 0 ? conjugates_of_magnification(lens, settings.magnification)
                                                          : conjugates_of_object(lens, settings.focus_distance_mm);
  FirstOrder out;
  out.efl_mm = lens.efl_mm;
  out.focus_distance_mm = plane.object_mm;
  out.array_distance_mm = plane.image_mm;
  out.exit_pupil_mm = lens.h2_z_mm + plane.image_mm - lens.exit_pupil_z_mm;
  out.cone_slope = lens.exit_pupil_radius_mm / std::abs(out.exit_pupil_mm);
  out.entrance_pupil_mm = lens.entrance_pupil_z_mm - (lens.h1_z_mm - plane.object_mm);
  return out;
}

void check(const FirstOrder& figures, const LensAnalysis& lens, const ScenarioSettings& scenario) {
  const auto fail = [](const std::string& what) { throw Error(ExitCode::configuration, "main_lens: " + what); };
  const double nearest = figures.focus_distance_mm - half_depth_mm(scenario);
  if (!(lens.efl_mm > 0)) fail(fmt::format("the prescription diverges (EFL {:.3f} mm): no real image", lens.efl_mm));
  if (!(nearest > 1.02 * lens.efl_mm))
    fail(
        fmt::format("particles come as near as {:.3f} mm to H1, within the focal length {:.3f} mm: no real image; set "
                    "main_lens.magnification or focus_distance_mm, or make the depth smaller",
                    nearest, lens.efl_mm));
  if (!(nearest > lens.h1_z_mm))
    fail(
        fmt::format("particles come as near as {:.3f} mm to H1, but the first surface is {:.3f} mm before H1: they "
                    "would be inside the lens",
                    nearest, lens.h1_z_mm));
  if (!(lens.h2_z_mm + figures.array_distance_mm > lens.length_mm))
    fail("the image of the focused plane lies inside the lens; set main_lens.magnification or focus_distance_mm");
  if (!(figures.exit_pupil_mm > 0))
    fail("the exit pupil lies behind the array, which calibrations cannot say; use another magnification");
}

std::vector<Rim> rims_of(const MainLensSettings& lens) {
  std::vector<Rim> rims;
  for (std::size_t i = 0; i < lens.rim_z_mm.size(); ++i) rims.push_back({lens.rim_z_mm[i], lens.rim_radius_mm[i]});
  return rims;
}

LensRay ray_of(double x, double y, double z, double slope_x, double slope_y, double direction) {
  const double scale = 1 / std::sqrt(1 + slope_x * slope_x + slope_y * slope_y);
  return {x, y, z, slope_x * scale, slope_y * scale, direction * scale};
}

}  // namespace

PrescriptionLens::System PrescriptionLens::make_system(const ScenarioSettings& scenario) {
  const auto& settings = scenario.main_lens;
  const Prescription lens = read_prescription(find_shipped("prescriptions", settings.prescription));
  if (const double open = lens.surfaces[lens.stop].clear_radius_mm; settings.stop_radius_mm > open)
    throw Error(ExitCode::configuration, fmt::format("main_lens.stop_radius_mm = {} is wider than the stop of the lens "
                                                     "({} mm); make it smaller, or 0 for fully open",
                                                     settings.stop_radius_mm, open));
  const LensAnalysis analysis = analyse(lens, settings.stop_radius_mm);
  const FirstOrder figures = figures_of(analysis, settings);
  check(figures, analysis, scenario);
  return {analysis, LensTracer(lens, settings.stop_radius_mm, rims_of(settings)), figures};
}

PrescriptionLens::PrescriptionLens(const ScenarioSettings& scenario)
    : PrescriptionLens(make_system(scenario), scenario) {}

PrescriptionLens::PrescriptionLens(System system, const ScenarioSettings& scenario)
    : MainLens(system.figures),
      system_(std::move(system)),
      object_z_mm_(system_.analysis.h1_z_mm - first_order().focus_distance_mm),
      array_z_mm_(system_.analysis.h2_z_mm + first_order().array_distance_mm) {
  const double depth = half_depth_mm(scenario), x = 0.5 * scenario.seeding.volume_x_mm;
  const double y = 0.5 * scenario.seeding.volume_y_mm;
  for (const double z : {object_z_mm_ - depth, object_z_mm_ + depth})
    for (const auto& [px, py] : {std::pair{0.0, 0.0}, {x, 0.0}, {0.0, y}, {x, y}})
      object_margin_ = std::max(object_margin_, widening(px, py, z));
  const double right = 5e-4 * scenario.camera.pixel_um * static_cast<double>(scenario.camera.width_px);
  const double bottom = 5e-4 * scenario.camera.pixel_um * static_cast<double>(scenario.camera.height_px);
  for (const auto& [px, py] : {std::pair{0.0, 0.0}, {right, 0.0}, {0.0, bottom}, {right, bottom}})
    array_margin_ = std::max(array_margin_, widening(px, py, array_z_mm_));
}

/// From a point before or behind the lens towards a point of the stop, paraxially.
LensRay PrescriptionLens::aimed(double x, double y, double z, double stop_x, double stop_y) const noexcept {
  const bool before = z < 0;
  const StopMap& map = before ? system_.analysis.from_object : system_.analysis.from_image;
  const double per_slope = map.slope + map.height * (before ? -z : z - system_.analysis.length_mm);
  return ray_of(x, y, z, (stop_x - map.height * x) / per_slope, (stop_y - map.height * y) / per_slope,
                before ? 1.0 : -1.0);
}

/// How far beyond the paraxial rim of the stop rays from this point must be aimed to reach its real rim.
double PrescriptionLens::widening(double x, double y, double z) const noexcept {
  constexpr int kAzimuths = 16, kHalvings = 12;
  constexpr double kWidest = 2, kReserve = 1.01;
  double widest = 1;
  for (int i = 0; i < kAzimuths; ++i) {
    const double angle = 2 * std::numbers::pi * i / kAzimuths;
    const double c = stop_radius_mm() * std::cos(angle), s = stop_radius_mm() * std::sin(angle);
    const auto passes = [&](double wider) {
      const double height = system_.tracer.height_at_stop(aimed(x, y, z, wider * c, wider * s));
      return height >= 0 && height <= stop_radius_mm();
    };
    if (!passes(widest)) continue;
    double inside = widest, outside = kWidest;
    for (int step = 0; step < kHalvings; ++step) {
      const double middle = 0.5 * (inside + outside);
      (passes(middle) ? inside : outside) = middle;
    }
    widest = inside;
  }
  return widest * kReserve;
}

void PrescriptionLens::trace(const Vector3& object, double body_mm, std::span<const RaySample> samples, double turn_rad,
                             std::span<ArrayRay> rays) const noexcept {
  const double reach = object_margin_ * stop_radius_mm(), weight = object_margin_ * object_margin_;
  const double c = reach * std::cos(turn_rad), s = reach * std::sin(turn_rad);
  std::array<LensRay, kBatch> batch;
  for (std::size_t first = 0; first < samples.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, samples.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const RaySample& sample = samples[first + i];
      batch[i] = aimed(object.x + body_mm * sample.body_x, object.y + body_mm * sample.body_y, object_z_mm_ + object.z,
                       c * sample.pupil_x - s * sample.pupil_y, s * sample.pupil_x + c * sample.pupil_y);
      // A particle that shines evenly sees the pupil's area by the cube of the cosine.
      rays[first + i].weight = weight * batch[i].n * batch[i].n * batch[i].n;
    }
    system_.tracer.forward(std::span(batch).first(count));
    for (std::size_t i = 0; i < count; ++i) {
      const LensRay& ray = batch[i];
      if (ray.n == 0) {
        rays[first + i] = {};
        continue;
      }
      const double slope_x = ray.l / ray.n, slope_y = ray.m / ray.n, length = array_z_mm_ - ray.z;
      const double x = ray.x + length * slope_x, y = ray.y + length * slope_y;
      rays[first + i] = {x, y, slope_x, slope_y, rays[first + i].weight};
    }
  }
}

void PrescriptionLens::white(double x_mm, double y_mm, double reach_mm, std::span<const RaySample> samples,
                             std::span<ArrayRay> rays) const noexcept {
  const double stop = array_margin_ * stop_radius_mm(), weight = array_margin_ * array_margin_;
  std::array<LensRay, kBatch> batch;
  for (std::size_t first = 0; first < samples.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, samples.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const RaySample& sample = samples[first + i];
      const double x = x_mm + reach_mm * sample.body_x, y = y_mm + reach_mm * sample.body_y;
      const LensRay& ray = batch[i] = aimed(x, y, array_z_mm_, stop * sample.pupil_x, stop * sample.pupil_y);
      const double cosine2 = ray.n * ray.n;  // even radiance: the fourth power of the cosine
      rays[first + i] = {x, y, ray.l / ray.n, ray.m / ray.n, weight * cosine2 * cosine2};
    }
    system_.tracer.backward(std::span(batch).first(count));
    for (std::size_t i = 0; i < count; ++i)
      if (batch[i].n == 0) rays[first + i].weight = 0;
  }
}

}  // namespace rptv
