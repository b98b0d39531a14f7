// SPDX-License-Identifier: MIT
// Scenario, rig, tracers and renderers put together.
#include "tests/bench/lpt_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/challenge_rig.hpp"
#include "simulation/scenario.hpp"

namespace rptv::bench {

namespace {

ScenarioSettings scenario_of(double per_pixel, double sensor_part) {
  ScenarioSettings scenario = read_scenario(RPTV_SOURCE_DIR "/simulation/scenarios/lpt_challenge.toml");
  scenario.views.per_pixel = per_pixel, scenario.views.sensor_part = sensor_part;
  return scenario;
}

}  // namespace

LptScene::LptScene(double per_pixel, double sensor_part)
    : rig_(rig_of(scenario_of(per_pixel, sensor_part))),
      scenario_(fitted_to_rig(scenario_of(per_pixel, sensor_part), rig_)),
      tracers_(scenario_),
      images_({static_cast<std::uint32_t>(scenario_.camera.width_px),
               static_cast<std::uint32_t>(scenario_.camera.height_px), 1},
              static_cast<std::uint32_t>(rig_.cameras.size())) {
  for (std::size_t c = 0; c < rig_.cameras.size(); ++c) renderers_.emplace_back(scenario_, rig_.cameras[c].model, c);
}

FrameSet& LptScene::frames(std::uint64_t frame) {
  frame_ = frame;
  truth_.clear();
  const auto lit = tracers_.lit(frame);
  for (std::size_t c = 0; c < renderers_.size(); ++c)
    renderers_[c].render(lit, frame, {images_.pixels(c), renderers_[c].shape().bytes()});
  for (std::size_t i = 0; i < lit.size(); ++i) {
    TruthRow row = truth_row(lit[i], frame, tracers_.time_s(frame));
    row.in_view = std::count_if(renderers_.begin(), renderers_.end(),
                                [&](const ViewRenderer& renderer) { return renderer.views()[i].in_view; }) >= 3;
    truth_.push_back(row);
  }
  return images_.set();
}

DetectionScore LptScene::judge(const Particles& particles) const {
  Measurement measured;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    TrackRow row{};
    row.frame = frame_, row.x_mm = particles.x_mm[i], row.y_mm = particles.y_mm[i], row.z_mm = particles.z_mm[i];
    measured.rows.push_back(row);
  }
  return score(measured, truth_, {{1 / px_per_mm(), 1 / px_per_mm(), 1 / px_per_mm()}}).detection;
}

LinkerSettings LptScene::linker_settings() const {
  const auto& box = scenario_.seeding;
  const double volume_mm3 = box.volume_x_mm * box.volume_y_mm * box.volume_z_mm;
  const double neighbour_mm = 0.554 * std::cbrt(volume_mm3 / static_cast<double>(box.particles));
  LinkerSettings settings;
  settings.search_range_mm =
      std::min(1.5 * make_flow(scenario_)->fastest_mm_s() / scenario_.rate_hz, 0.9 * neighbour_mm);
  settings.predict = "velocity";
  settings.memory = 1;
  settings.max_particles = settings.max_tracks = std::max<std::int64_t>(1024, 2 * box.particles);
  return settings;
}

MultiViewSettings LptScene::settings() const {
  const auto& box = scenario_.seeding;
  const auto& camera = scenario_.camera;
  const auto reach = [](double size_mm) { return std::vector<double>{-0.55 * size_mm - 1, 0.55 * size_mm + 1}; };
  MultiViewSettings settings;
  settings.rig = "cameras.toml";
  settings.volume_x_mm = reach(box.volume_x_mm), settings.volume_y_mm = reach(box.volume_y_mm);
  settings.volume_z_mm = reach(box.volume_z_mm);
  settings.tolerance_px = 0.5;
  settings.max_particles = std::max<std::int64_t>(1024, 2 * box.particles);
  settings.max_matches = 8 * settings.max_particles;
  const double sigma = scenario_.views.sigma_px;
  auto& detector = settings.detector;
  detector.background = camera.black_level_dn;
  detector.noise_grey = camera.read_noise_e / camera.gain_e_per_dn;
  detector.threshold = 0.1 * box.photoelectrons / (2 * std::numbers::pi * sigma * sigma + 1) / camera.gain_e_per_dn;
  detector.electrons_per_grey = camera.gain_e_per_dn;
  detector.max_detections = detector.max_overlapping = settings.max_particles;
  detector.find_hidden = true;
  return settings;
}

}  // namespace rptv::bench
