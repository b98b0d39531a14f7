// SPDX-License-Identifier: MIT
// The configuration that fits a simulated run: volume, threshold and search range from the scenario.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "daemon/simulated_run.hpp"
#include "simulation/optics.hpp"

namespace rptv {

namespace {

/// Mean nearest neighbour of randomly seeded particles, mm (Chandrasekhar 1943).
double neighbour_distance_mm(const SeedingSettings& seeding) {
  const double volume = seeding.volume_x_mm * seeding.volume_y_mm * seeding.volume_z_mm;
  return 0.554 * std::cbrt(volume / std::max(1.0, static_cast<double>(seeding.particles)));
}

/// Standard deviation of a dark pixel, grey values.
double noise_dn(const CameraSettings& camera) {
  return std::hypot(camera.read_noise_e, std::sqrt(camera.background_e)) / camera.gain_e_per_dn;
}

/// A tenth of the grey value that a particle's light gives when spread over its own disc of slopes, above the
/// background.
double threshold_dn(const ScenarioSettings& scenario, const LightFieldOptics& optics) {
  const double disc_px = scenario.lenslets.focal_length_mm * optics.cone_slope() / (scenario.camera.pixel_um * 1e-3);
  const double grey =
      scenario.seeding.photoelectrons / (std::numbers::pi * disc_px * disc_px + 1.0) / scenario.camera.gain_e_per_dn;
  return std::max(0.1 * grey, 6.0 * noise_dn(scenario.camera) + 1.0);
}

/// Half of a box, and a little more for what swings out of it.
double reach_mm(double volume_mm) { return 0.55 * volume_mm + 1; }

/// Lenslets that one pixel may belong to: as many sub-images as overlap in it at most.
int hypotheses(const LightFieldOptics& optics) {
  constexpr int kMost = 16;
  const int across = static_cast<int>(std::ceil(optics.calibration().subimage_overlap() - 0.02));
  return std::clamp(across * across, 1, kMost);
}

/// Particle images overlap so often that one look at each image loses many.
bool is_dense(const ScenarioSettings& scenario) {
  constexpr double kDensePerPixel = 0.01;
  const auto pixels = static_cast<double>(scenario.camera.width_px * scenario.camera.height_px);
  return static_cast<double>(scenario.seeding.particles) > kDensePerPixel * pixels;
}

}  // namespace

std::string rig_toml(const ScenarioSettings& scenario) {
  const LightFieldOptics optics(scenario);
  const double half_depth = half_depth_mm(scenario);
  const double from = std::floor(optics.image_of({0, 0, half_depth}).z - 1);
  const double to = std::ceil(optics.image_of({0, 0, -half_depth}).z + 1);
  const double step_mm = make_flow(scenario)->fastest_mm_s() / scenario.rate_hz;
  const double range_mm = std::max(1.5 * step_mm, 0.9 * neighbour_distance_mm(scenario.seeding));
  return fmt::format(
      "# A configuration for this simulated run: rapidptv run --config rig.toml\n"
      "schema = 1\n\n"
      "[replay]\npath = \"frames\"\npreload = true\n\n"
      "[intake]\npolicy = \"bounded\"\ndepth = 32  # a third of a second at 100 Hz: what a busy machine may hold "
      "frames up\npool_frames = 40\n\n"
      "[light_field]\ncalibration = \"calibration.toml\"\nbackground_image = \"background.png\"\n"
      "threshold = {:.1f}\nmax_hypotheses = {}\nvolume_z_mm = [{:.1f}, {:.1f}]\nparticle_radius_um = "
      "{:.1f}\nwavelength_nm = {:.1f}\n"
      "noise_grey = {:.3f}\nelectrons_per_grey = {:.3f}\n\n"
      "[linker]\nsearch_range_mm = {:.3f}\nmemory = 3\n",
      threshold_dn(scenario, optics), hypotheses(optics), from, to, scenario.seeding.particle_radius_um,
      scenario.lenslets.diffraction ? scenario.lenslets.wavelength_nm : 0.0, noise_dn(scenario.camera),
      scenario.camera.gain_e_per_dn, range_mm);
}

std::string views_rig_toml(const ScenarioSettings& scenario, std::size_t views) {
  const auto& box = scenario.seeding;
  const auto& camera = scenario.camera;
  const double sigma = scenario.views.sigma_px;
  const double peak_dn = box.photoelectrons / (2 * std::numbers::pi * sigma * sigma + 1) / camera.gain_e_per_dn;
  const double step_mm = make_flow(scenario)->fastest_mm_s() / scenario.rate_hz;
  const double apart_mm = 0.9 * neighbour_distance_mm(box);
  const std::int64_t capacity = std::max<std::int64_t>(1024, 2 * box.particles);
  return fmt::format(
      "# A configuration for this simulated run: rapidptv run --config rig.toml\n"
      "schema = 1\n\n"
      "[replay]\npath = \"frames\"\nspeed = 0.0\n\n"
      "[intake]\npolicy = \"lossless\"\n\n"
      "[reconstruction]\nkind = \"multi_view\"\n\n"
      "[multi_view]\nrig = \"cameras.toml\"\nmethod = \"{11}\"\nvolume_x_mm = [-{0:.3f}, {0:.3f}]\nvolume_y_mm = "
      "[-{1:.3f}, {1:.3f}]\n"
      "volume_z_mm = [-{2:.3f}, {2:.3f}]\nmin_views = {3}\ntolerance_px = 0.5\nmax_particles = {4}\nmax_matches = "
      "{5}\n\n"
      "[multi_view.detector]\nbackground = {6:.3f}\nthreshold = {7:.2f}\nnoise_grey = {8:.4f}\n"
      "electrons_per_grey = {9:.4f}\nmax_detections = {4}\nfind_hidden = true\nmax_overlapping = {4}\n\n"
      "[linker]\nsearch_range_mm = {10:.3f}\npredict = \"velocity\"\nmemory = 1\nmax_particles = {4}\nmax_tracks = "
      "{4}\n",
      reach_mm(box.volume_x_mm), reach_mm(box.volume_y_mm), reach_mm(box.volume_z_mm), views >= 3 ? 3 : 2, capacity,
      8 * capacity, camera.black_level_dn + camera.background_e / camera.gain_e_per_dn,
      std::max(0.1 * peak_dn, 6.0 * noise_dn(camera)), noise_dn(camera), camera.gain_e_per_dn,
      step_mm > 0 ? std::min(1.5 * step_mm, apart_mm) : apart_mm, is_dense(scenario) ? "iterative" : "detections");
}

}  // namespace rptv
