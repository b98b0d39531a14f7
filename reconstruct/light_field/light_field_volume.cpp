// SPDX-License-Identifier: MIT
// Voxels, gates and limits of light-field reconstruction.
#include "reconstruct/light_field/light_field_volume.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibration/light_field/object_map.hpp"
#include "core/error.hpp"
#include "reconstruct/light_field/light_field.hpp"
#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {

constexpr double kMostVoxels = 2e9;

[[noreturn]] void refuse(const std::string& text) { throw Error(ExitCode::configuration, text); }

struct Range {
  double from, to;
};

Range range_of(const char* key, const std::vector<double>& given, Range otherwise) {
  if (given.empty()) return otherwise;
  if (given.size() != 2)
    refuse(fmt::format("light_field.{} has {} numbers; give [from, to], or leave it out", key, given.size()));
  if (!(given[0] < given[1]))
    refuse(fmt::format("light_field.{} = [{}, {}] is empty; the first number must be the smaller", key, given[0],
                       given[1]));
  return {given[0], given[1]};
}

/// What rays through the sensor reach at the farther end of the depth range.
Range sensor_range(double axis_px, std::int64_t size_px, const LightFieldCalibration& calibration, Range z) {
  const double pupil = calibration.lens.exit_pupil_mm > 0 ? 1 / calibration.lens.exit_pupil_mm : 0;
  const double scale = std::max(1 - z.from * pupil, 1 - z.to * pupil) / calibration.apparent_scale();
  return {(-0.5 - axis_px) * calibration.pixel_mm() * scale,
          (static_cast<double>(size_px) - 0.5 - axis_px) * calibration.pixel_mm() * scale};
}

/// How far the outermost ray may be from where it is on the nearest plane, in voxels; 0: planes are as deep as voxels.
double farthest_drift(const std::string& counting) {
  return counting == "coarse_to_fine" ? 0.5 : counting == "coarse" ? 0.125 : 0;
}

std::int32_t voxels_in(Range range, double step_mm) {
  return static_cast<std::int32_t>(std::min(std::ceil((range.to - range.from) / step_mm - 1e-9), kMostVoxels));
}

/// First dark line of a lenslet's diffraction on the sensor, um.
double diffraction_zero_um(const LightFieldSettings& settings, const LightFieldCalibration& calibration) {
  return settings.wavelength_nm * 1e-3 * calibration.lenslets.focal_length_mm / calibration.pitch_mm();
}

}  // namespace

void check_choices(const LightFieldSettings& settings) {
  if (settings.counting == "coarse_to_fine" && settings.classification == "dbscan")
    refuse(
        "light_field.classification = \"dbscan\" needs clouds of voxels, which light_field.counting = "
        "\"coarse_to_fine\" does not make; choose counting = \"coarse\" or \"exhaustive\"");
  if (settings.refine_search == "grey_values" && !settings.refine)
    refuse(
        "light_field.refine_search = \"grey_values\" is a way to refine; set light_field.refine = true, or "
        "leave refine_search out");
}

VoxelGrid make_grid(const LightFieldSettings& settings, const LightFieldCalibration& calibration,
                    double slope_half_range) {
  const Range z = range_of("volume_z_mm", settings.volume_z_mm, {0, 0});
  const double limit_mm = std::min(ObjectMap(calibration).highest_z_mm(),
                                   calibration.lens.exit_pupil_mm > 0 ? calibration.lens.exit_pupil_mm : 1e300);
  if (!(z.to < limit_mm))
    refuse(fmt::format(
        "light_field.volume_z_mm ends at {} mm, but images are only formed up to {:.6g} mm before the array", z.to,
        limit_mm));
  const auto axis = calibration.optical_axis_px();
  const Range x =
      range_of("volume_x_mm", settings.volume_x_mm, sensor_range(axis[0], calibration.sensor.width_px, calibration, z));
  const Range y = range_of("volume_y_mm", settings.volume_y_mm,
                           sensor_range(axis[1], calibration.sensor.height_px, calibration, z));
  const double step_x = settings.voxel_um.at(0) * 1e-3, step_y = settings.voxel_um.at(1) * 1e-3;
  double step_z = settings.voxel_um.at(2) * 1e-3;
  const double drift = farthest_drift(settings.counting) * std::min(step_x, step_y);
  if (slope_half_range > 0) step_z = std::max(step_z, 2 * drift / slope_half_range);
  if (settings.counting == "coarse_to_fine") step_z = (z.to - z.from) / voxels_in(z, step_z);  // fills the volume
  VoxelGrid grid;
  grid.size_x = voxels_in(x, step_x), grid.size_y = voxels_in(y, step_y), grid.planes = voxels_in(z, step_z);
  const double voxels = (grid.size_x + 2.0) * (grid.size_y + 2.0) * grid.planes;
  if (!(voxels <= kMostVoxels) || (grid.size_x + 2.0) * (grid.size_y + 2.0) > 1e9)
    refuse(
        fmt::format("light_field.voxel_um = [{}, {}, {}] makes {:.3g} voxels; make them larger or the volume smaller",
                    settings.voxel_um[0], settings.voxel_um[1], settings.voxel_um[2], voxels));
  grid.step_x_mm = static_cast<float>(step_x), grid.step_y_mm = static_cast<float>(step_y);
  grid.step_z_mm = static_cast<float>(step_z);
  grid.first_x_mm = static_cast<float>(x.from + step_x / 2), grid.first_y_mm = static_cast<float>(y.from + step_y / 2);
  grid.first_z_mm = static_cast<float>(z.from + step_z / 2);
  return grid;
}

double min_count_by_eq7(const LightFieldCalibration& calibration, double particle_radius_um) noexcept {
  const double radius_px = particle_radius_um * calibration.magnification() / calibration.sensor.pixel_um;
  return std::floor(0.5 * radius_px * radius_px * std::numbers::pi);  // eq. (7)
}

std::uint16_t make_min_count(const LightFieldSettings& settings, const LightFieldCalibration& calibration) {
  if (settings.min_count > 0) return static_cast<std::uint16_t>(settings.min_count);
  if (!(settings.particle_radius_um > 0))
    refuse("light_field.particle_radius_um is missing; give it for eq. (7), or give light_field.min_count");
  const double count = min_count_by_eq7(calibration, settings.particle_radius_um);
  if (!(count >= 3 && count <= 65535))
    refuse(
        fmt::format("light_field.particle_radius_um = {} gives C_min = {} by eq. (7), outside 3 to 65535; "
                    "give light_field.min_count",
                    settings.particle_radius_um, count));
  return static_cast<std::uint16_t>(count);
}

ExplainOptions make_explain_options(const LightFieldSettings& settings, const LightFieldCalibration& calibration,
                                    const VoxelGrid& grid, std::uint16_t min_count) {
  constexpr double kUnknownRadius = 0.25;  // of a pitch
  const double turn = calibration.lenslets.rotation_deg * std::numbers::pi / 180;
  const double focal_mm = calibration.lenslets.focal_length_mm, pitch_mm = calibration.pitch_mm();
  const double radius_mm = settings.particle_radius_um * 1e-3 * calibration.magnification();
  const double pixel = calibration.pixel_mm() / focal_mm;
  // The part of a square lenslet's diffraction that is brighter than a usual threshold has this rms.
  const double blur =
      std::hypot(settings.slope_blur_um, 0.33 * diffraction_zero_um(settings, calibration)) * 1e-3 / focal_mm;
  ExplainOptions options;
  options.fit.gate = {std::cos(turn), std::sin(turn),
                      pitch_mm / 2 + (radius_mm > 0 ? std::min(radius_mm, pitch_mm / 2) : kUnknownRadius * pitch_mm),
                      0.5 * calibration.pixel_mm() / focal_mm};
  options.fit.start_margin_mm = 0.75 * std::max(grid.step_x_mm, grid.step_y_mm);
  options.fit.start_depth_mm = grid.step_z_mm;
  options.fit.slope_variance = pixel * pixel / 12 + blur * blur;
  options.fit.pitch_mm = pitch_mm;
  options.fit.min_support = std::max<double>(min_count, 3);
  options.claim = settings.explain_away;
  const double voxel_mm = settings.voxel_um[2] * 1e-3;
  options.lowest_z_mm = settings.volume_z_mm[0] - voxel_mm, options.highest_z_mm = settings.volume_z_mm[1] + voxel_mm;
  options.max_particles = static_cast<std::size_t>(settings.max_particles);
  options.max_candidates = 4 * options.max_particles;
  options.max_rays = static_cast<std::size_t>(settings.max_rays);
  options.threads = thread_count(settings.threads);
  return options;
}

ShakeOptions make_shake_options(const LightFieldSettings& settings, const LightFieldCalibration& calibration,
                                const ExplainOptions& explain) {
  const double f_number = calibration.lens.image_f_number, pupil_mm = calibration.lens.exit_pupil_mm;
  ShakeOptions options;
  if (f_number > 0) options.model.pupil_radius_mm = 0.5 / f_number * (pupil_mm > 0 ? pupil_mm : 1);
  options.model.particle_radius_mm = settings.particle_radius_um * 1e-3 * calibration.magnification();
  if (calibration.base_model() == "thick_lens")  // m = s'/EFL - 1
    options.model.radius_per_mm = -1 / (calibration.lens.array_distance_mm - calibration.lens.focal_length_mm);
  options.model.spread_um = settings.slope_blur_um;
  options.model.diffraction_zero_um = diffraction_zero_um(settings, calibration);
  options.sweeps = settings.refine_sweeps;
  options.dark_noise_grey = settings.noise_grey;
  options.electrons_per_grey = settings.electrons_per_grey;
  options.lowest_z_mm = explain.lowest_z_mm, options.highest_z_mm = explain.highest_z_mm;
  // Where the cone of light is less than two lenslets wide.
  if (f_number > 0) options.shallow_mm = 2 * calibration.pitch_mm() * f_number;
  options.pitch_mm = calibration.pitch_mm();
  if (f_number > 0) {
    options.slope_rms = 0.25 / f_number;
    options.subimage_px = calibration.lenslets.focal_length_mm / f_number / calibration.pixel_mm();
  }
  options.satellite_mm = std::max(calibration.pitch_mm() / 4, options.model.particle_radius_mm);
  options.lit_grey = settings.threshold;
  options.least_share = settings.ghost_share;
  options.max_particles = explain.max_particles;
  options.threads = explain.threads;
  return options;
}

}  // namespace rptv
