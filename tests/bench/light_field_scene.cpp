// SPDX-License-Identifier: MIT
// Scenes with truth, rendered or read.
#include "tests/bench/light_field_scene.hpp"

#include "core/csv.hpp"
#include "reconstruct/light_field/light_field_volume.hpp"
#include "reconstruct/light_field/pixels_to_rays.hpp"
#include "simulation/render_light_field.hpp"
#include "tests/calibration/light_field/traced_set.hpp"

namespace rptv::bench {

namespace {

constexpr std::uint16_t kAnyCount = 3;

KnownScene shared_scene(const std::string& set, const std::string& image, const LightFieldCalibration& calibration) {
  KnownScene scene;
  scene.name = set + ' ' + image;
  scene.calibration = calibration;
  const testing::DecodedImage decoded(*testing::shared_set(set) / image);
  scene.shape = decoded.shape, scene.pixels = decoded.bytes;
  scene.settings.space = "image";
  return scene;
}

}  // namespace

KnownScene simulated_scene(const std::string& name, const ScenarioSettings& scenario, std::uint64_t frame) {
  LightFieldRenderer renderer(scenario);
  KnownScene scene;
  scene.name = name;
  scene.calibration = renderer.optics().calibration();
  scene.shape = renderer.shape();
  scene.pixels.resize(scene.shape.bytes());
  const std::vector<Tracer> tracers = Tracers(scenario).lit(frame);
  renderer.render(tracers, frame, scene.pixels);
  double low = 0, high = 0;
  for (std::size_t i = 0; i < tracers.size(); ++i) {
    const auto at = renderer.optics().convergence(tracers[i].position);
    if (!at) continue;
    scene.truth.push_back({{at->x, at->y, at->z}, renderer.lights()[i].photoelectrons / scenario.camera.gain_e_per_dn});
    scene.in_view.push_back(renderer.lights()[i].in_view ? 1 : 0);
    low = std::min(low, at->z), high = std::max(high, at->z);
  }
  auto& settings = scene.settings;
  settings.space = "image";
  settings.background = scenario.camera.black_level_dn + scenario.camera.background_e / scenario.camera.gain_e_per_dn;
  settings.particle_radius_um = scenario.seeding.particle_radius_um;
  settings.volume_z_mm = {std::floor(low - 1), std::ceil(high + 1)};
  settings.wavelength_nm = scenario.lenslets.diffraction ? scenario.lenslets.wavelength_nm : 0;
  settings.electrons_per_grey = scenario.camera.gain_e_per_dn;
  settings.noise_grey = std::max(0.1, scenario.camera.read_noise_e / scenario.camera.gain_e_per_dn);
  settings.threshold = 5;
  return scene;
}

std::optional<KnownScene> double_gauss_scene(const std::string& set, const std::string& image) {
  if (!testing::shared_set(set)) return {};
  KnownScene scene = shared_scene(set, image, set == "lf-edge" ? testing::edge_truth() : testing::macro_truth());
  scene.settings.threshold = 15, scene.settings.particle_radius_um = 30, scene.settings.volume_z_mm = {-16, 16};
  scene.settings.noise_grey = 0.625;
  constexpr double kPhotons = 383083, kGain = 4;
  for (const auto& pair : testing::traced_pairs(set)) {
    scene.truth.push_back({{pair.image[0], pair.image[1], pair.image[2]}, kPhotons / kGain});
    scene.in_view.push_back(1);
  }
  return scene;
}

std::optional<KnownScene> wall_scene(std::uint64_t frame) {
  const auto folder = testing::shared_set("lf-wall");
  if (!folder) return {};
  KnownScene scene = shared_scene("lf-wall", fmt::format("frame_{:03}.png", frame), testing::wall_truth());
  auto& settings = scene.settings;
  settings.threshold = 5, settings.particle_radius_um = 15, settings.volume_z_mm = {-36, 20};
  settings.wavelength_nm = 532, settings.noise_grey = 0.6, settings.electrons_per_grey = 5;
  CsvReader csv(*folder / "tracks.csv",
                {{"frame"}, {"Xi_mm"}, {"Yi_mm"}, {"Zi_mm"}, {"any_light_in_fov"}, {"footprint_fully_in_fov"}});
  constexpr double kPhotons = 15000, kGain = 5;
  while (csv.next()) {
    if (csv.index(0) != frame || csv.number(4) == 0) continue;
    scene.truth.push_back({{csv.number(1), csv.number(2), -csv.number(3)}, kPhotons / kGain});
    scene.in_view.push_back(csv.number(5) != 0 ? 1 : 0);
  }
  return scene;
}

ScenarioSettings random_scenario() {
  ScenarioSettings s;
  s.flow.kind = "random";
  s.seeding.particles = 60;
  s.seeding.volume_x_mm = s.seeding.volume_y_mm = 4, s.seeding.volume_z_mm = 6;
  s.seeding.photoelectrons = 15000;
  s.camera.width_px = s.camera.height_px = 1400, s.camera.pixel_um = 9;
  s.camera.gain_e_per_dn = 5, s.camera.read_noise_e = 2.5;
  return s;
}

ScenarioSettings dense_scenario(double per_lenslet, double depth_mm) {
  auto s = random_scenario();
  s.seeding.per_lenslet = per_lenslet;
  s.seeding.volume_x_mm = s.seeding.volume_y_mm = 2, s.seeding.volume_z_mm = depth_mm;  // 40 lenslets a side
  s.rays_per_particle = 2048;
  s.camera.width_px = s.camera.height_px = 880;
  s.seeding.particles = LightFieldOptics(s).particles_in_box();
  return s;
}

ShakeOptions shake_options_of(const KnownScene& scene) {
  const LensletLattice lattice(scene.calibration);
  const PixelsToRays pixels_to_rays(scene.calibration, lattice, 1);
  const VoxelGrid grid = make_grid(scene.settings, scene.calibration, pixels_to_rays.slope_half_range());
  return make_shake_options(scene.settings, scene.calibration,
                            make_explain_options(scene.settings, scene.calibration, grid, kAnyCount));
}

std::vector<FitCovariance> bounds_of(const KnownScene& scene) {
  const LensletLattice lattice(scene.calibration);
  const ShakeOptions shake = shake_options_of(scene);
  ImageModel model(scene.calibration, lattice, shake.model);
  return cramer_rao_bounds(model, scene.truth,
                           {shake.dark_noise_grey * shake.dark_noise_grey + 1.0 / 12, 1 / shake.electrons_per_grey});
}

std::vector<KnownMatch> match(const Particles& found, const KnownScene& scene, double lateral_mm, double depth_mm) {
  std::vector<testing::Position> truth;
  for (const auto& p : scene.truth) truth.push_back({p.at.x, p.at.y, p.at.z});
  std::vector<KnownMatch> matches;
  for (const auto& m : testing::match(found, truth, lateral_mm, depth_mm)) matches.push_back({m.found, m.truth});
  return matches;
}

}  // namespace rptv::bench
