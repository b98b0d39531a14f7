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

/// A tenth of the grey value that a particle's light gives when spread over its own disc of slopes, above the
/// background.
double threshold_dn(const ScenarioSettings& scenario, const LightFieldOptics& optics) {
  const double disc_px = scenario.lenslets.focal_length_mm * optics.cone_slope() / (scenario.camera.pixel_um * 1e-3);
  const double grey =
      scenario.seeding.photoelectrons / (std::numbers::pi * disc_px * disc_px + 1.0) / scenario.camera.gain_e_per_dn;
  const double noise =
      std::hypot(scenario.camera.read_noise_e, std::sqrt(scenario.camera.background_e)) / scenario.camera.gain_e_per_dn;
  return std::max(0.1 * grey, 6.0 * noise + 1.0);
}

/// Lenslets that one pixel may belong to: as many sub-images as overlap in it at most.
int hypotheses(const LightFieldOptics& optics) {
  constexpr int kMost = 16;
  const int across = static_cast<int>(std::ceil(optics.calibration().subimage_overlap() - 0.02));
  return std::clamp(across * across, 1, kMost);
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
      scenario.lenslets.diffraction ? scenario.lenslets.wavelength_nm : 0.0,
      std::hypot(scenario.camera.read_noise_e, std::sqrt(scenario.camera.background_e)) / scenario.camera.gain_e_per_dn,
      scenario.camera.gain_e_per_dn, range_mm);
}

}  // namespace rptv
