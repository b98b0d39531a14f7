// SPDX-License-Identifier: MIT
// What a simulated experiment consists of: flow, particles, main lens, microlens array, camera; one struct with
// defaults.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/settings.hpp"

namespace rptv {

/// Wall at y = wall_y_mm, oscillating along x; fluid above it (y > wall_y_mm): Stokes' second problem plus a uniform
/// drift.
struct FlowSettings {
  double wall_y_mm = -3.5;
  double wall_amplitude_mm = 0.3;  ///< displacement amplitude A of the wall; velocity amplitude U = A w
  double frequency_hz = 5.0;
  double stokes_layer_mm = 1.0;  ///< delta = sqrt(2 nu / w) = 1/k
  double drift_x_mm_s = 0.3;
  double drift_z_mm_s = 0.2;
  void fields(FieldList& list);
};

/// Tracers without inertia, uniform in the lit box |x|, |y|, |z| <= volume/2 of object space.
struct SeedingSettings {
  std::int64_t particles = 200;      ///< mean number in the lit box
  double particle_radius_um = 15.0;  ///< half the diameter of its image, divided by the magnification
  double volume_x_mm = 7.0, volume_y_mm = 7.0, volume_z_mm = 7.0;
  double photoelectrons = 40000.0;  ///< per particle and frame at z = 0, in the whole image
  void fields(FieldList& list);
};

/// Thick lens with cardinal planes H1, H2 (eq. 8, 9) and a pupil.
struct MainLensSettings {
  double efl_mm = 25.0;
  double focus_distance_mm = 35.0;  ///< from H1 to the plane conjugate to the microlens array (object z = 0)
  double entrance_pupil_mm = 3.0;   ///< behind H1
  double f_number = 9.0;            ///< efl / entrance pupil diameter
  void fields(FieldList& list);
};

/// Square cells of ideal thin lenslets, sensor in their focal plane: light of slope s leaves at centre + s f.
struct LensletArraySettings {
  double pitch_mm = 0.125;
  double focal_length_mm = 3.75;
  double rotation_deg = 0.19;
  double offset_x_mm = -0.0222, offset_y_mm = 0.0287;  ///< centre of lenslet (0, 0), image space
  bool diffraction = true;                             ///< of a square lenslet: sinc^2 in x and y
  double wavelength_nm = 532.0;
  void fields(FieldList& list);
};

/// Ideal mono camera: Poisson photoelectrons, Gaussian read noise, linear gain, clipping.
struct CameraSettings {
  std::int64_t width_px = 960, height_px = 960;
  double pixel_um = 18.0;
  std::int64_t bits = 12;
  double gain_e_per_dn = 4.0;
  double read_noise_e = 0.9;
  double black_level_dn = 32.0;
  double background_e = 0.0;  ///< stray light per pixel, photoelectrons
  bool noise = true;          ///< shot and read noise; false: expected values, rounded
  void fields(FieldList& list);
};

/// One simulated run. Same seed and settings give the same images on every machine and for every number of threads.
struct ScenarioSettings {
  std::int64_t seed = 1;
  std::int64_t frames = 300;
  double rate_hz = 100.0;
  std::int64_t rays_per_particle = 768;  ///< quadrature points for the expected image of one particle
  FlowSettings flow;
  SeedingSettings seeding;
  MainLensSettings main_lens;
  LensletArraySettings lenslets;
  CameraSettings camera;
  void fields(FieldList& list);
};

inline constexpr std::int64_t kScenarioSchema = 1;

/// Reads a scenario TOML over the defaults and checks it as a whole. Throws Error (no_input, configuration). Set-up
/// only.
ScenarioSettings read_scenario(const std::filesystem::path& file);

/// Throws Error(configuration) when fields contradict each other (volume reaches the front focal plane, a particle that
/// moves more than the box, …). `origin` is the file's name in the message.
void check_scenario(const ScenarioSettings& scenario, const std::string& origin);

}  // namespace rptv
