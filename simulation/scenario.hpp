// SPDX-License-Identifier: MIT
// What a simulated experiment consists of: flow, particles, main lens, microlens array, camera, or a rig of cameras;
// one struct with defaults.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/settings.hpp"
#include "simulation/camera_settings.hpp"
#include "simulation/flow_settings.hpp"
#include "simulation/views_settings.hpp"

namespace rptv {

/// One simulated run. Same seed and settings give the same images on every machine and for every number of threads.
struct ScenarioSettings {
  std::int64_t seed = 1;
  std::int64_t frames = 300;
  double rate_hz = 100.0;
  std::int64_t rays_per_particle = 768;  ///< quadrature points for the expected image of one particle
  FlowSettings flow;
  DuctSettings duct;
  WavesSettings waves;
  LayerSettings layers;
  SeedingSettings seeding;
  MainLensSettings main_lens;
  LensletArraySettings lenslets;
  CameraSettings camera;
  ViewsSettings views;
  void fields(FieldList& list);
};

inline constexpr std::int64_t kScenarioSchema = 1;

/// Reads a scenario TOML over the defaults and checks it as a whole. Throws Error (no_input, configuration). Set-up
/// only.
ScenarioSettings read_scenario(const std::filesystem::path& file);

/// How far particles reach from the focused plane along the axis, mm.
double half_depth_mm(const ScenarioSettings& scenario);

/// Throws Error(configuration) when fields contradict each other (volume reaches the front focal plane, a particle that
/// moves more than the box, …). `origin` is the file's name in the message.
void check_scenario(const ScenarioSettings& scenario, const std::string& origin);

}  // namespace rptv
