// SPDX-License-Identifier: MIT
// The fields of a scenario, its reading and its checks.
#include "simulation/scenario.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/error.hpp"

namespace rptv {

void FlowSettings::fields(FieldList& list) {
  list.number("wall_y_mm", wall_y_mm, -1e3, 1e3, "height of the wall, mm; the fluid is above it");
  list.number("wall_amplitude_mm", wall_amplitude_mm, 0, 1e2, "displacement amplitude of the wall along x, mm");
  list.number("frequency_hz", frequency_hz, 1e-3, 1e5, "frequency of the wall, Hz");
  list.number("stokes_layer_mm", stokes_layer_mm, 1e-3, 1e3, "Stokes layer thickness sqrt(2 nu / omega), mm");
  list.number("drift_x_mm_s", drift_x_mm_s, -1e4, 1e4, "uniform drift along x, mm/s");
  list.number("drift_z_mm_s", drift_z_mm_s, -1e4, 1e4, "uniform drift along z (towards the lens), mm/s");
}

void SeedingSettings::fields(FieldList& list) {
  list.integer("particles", particles, 0, 100000, "mean number of particles in the lit box");
  list.number("particle_radius_um", particle_radius_um, 0, 1e3, "radius of a particle, um");
  list.number("volume_x_mm", volume_x_mm, 1e-3, 1e3, "lit box along x, centred on the axis, mm");
  list.number("volume_y_mm", volume_y_mm, 1e-3, 1e3, "lit box along y, mm");
  list.number("volume_z_mm", volume_z_mm, 1e-3, 1e3, "lit box along z, centred on the focused plane, mm");
  list.number("photoelectrons", photoelectrons, 0, 1e7, "photoelectrons per particle and frame at z = 0");
}

void MainLensSettings::fields(FieldList& list) {
  list.number("efl_mm", efl_mm, 1e-1, 1e4, "effective focal length, mm");
  list.number("focus_distance_mm", focus_distance_mm, 1e-1, 1e5, "H1 to the focused plane (object z = 0), mm");
  list.number("entrance_pupil_mm", entrance_pupil_mm, -1e4, 1e4, "entrance pupil behind H1, mm");
  list.number("f_number", f_number, 0.5, 1e3, "efl / entrance pupil diameter");
}

void LensletArraySettings::fields(FieldList& list) {
  list.number("pitch_mm", pitch_mm, 1e-3, 1e1, "lenslet pitch, mm");
  list.number("focal_length_mm", focal_length_mm, 1e-2, 1e3, "lenslet focal length = distance to the sensor, mm");
  list.number("rotation_deg", rotation_deg, -45, 45, "rotation of the array against the sensor, degrees");
  list.number("offset_x_mm", offset_x_mm, -1e2, 1e2, "centre of lenslet (0, 0), mm");
  list.number("offset_y_mm", offset_y_mm, -1e2, 1e2, "centre of lenslet (0, 0), mm");
  list.flag("diffraction", diffraction, "blur by the square lenslet's diffraction (sinc^2)");
  list.number("wavelength_nm", wavelength_nm, 100, 2000, "wavelength of the light, nm");
}

void CameraSettings::fields(FieldList& list) {
  list.integer("width_px", width_px, 16, 16384, "image width, px");
  list.integer("height_px", height_px, 16, 16384, "image height, px");
  list.number("pixel_um", pixel_um, 0.5, 100, "pixel pitch, um");
  list.integer("bits", bits, 8, 16, "significant bits of a grey value");
  list.number("gain_e_per_dn", gain_e_per_dn, 1e-3, 1e4, "photoelectrons per grey value");
  list.number("read_noise_e", read_noise_e, 0, 1e3, "read noise, photoelectrons rms");
  list.number("black_level_dn", black_level_dn, -1e3, 1e4, "grey value of a dark pixel");
  list.number("background_e", background_e, 0, 1e5, "stray light per pixel and frame, photoelectrons");
  list.flag("noise", noise, "shot and read noise");
}

void ScenarioSettings::fields(FieldList& list) {
  list.integer("seed", seed, 0, std::numeric_limits<std::int64_t>::max(), "seed of every random number");
  list.integer("frames", frames, 1, 10000000, "number of frames");
  list.number("rate_hz", rate_hz, 1e-3, 1e6, "frame rate, Hz");
  list.integer("rays_per_particle", rays_per_particle, 16, 1000000, "quadrature rays per particle image");
  list.section("flow", flow);
  list.section("seeding", seeding);
  list.section("main_lens", main_lens);
  list.section("lenslets", lenslets);
  list.section("camera", camera);
}

ScenarioSettings read_scenario(const std::filesystem::path& file) {
  ScenarioSettings scenario;
  FieldList list;
  scenario.fields(list);
  read_toml_file(file, "scenario", kScenarioSchema, list);
  check_scenario(scenario, file.string());
  return scenario;
}

void check_scenario(const ScenarioSettings& scenario, const std::string& origin) {
  const auto fail = [&](const std::string& what) { throw Error(ExitCode::configuration, origin + ": " + what); };
  const auto& lens = scenario.main_lens;
  const double nearest = lens.focus_distance_mm - 0.5 * scenario.seeding.volume_z_mm;
  if (nearest <= 1.02 * lens.efl_mm)
    fail(
        fmt::format("main_lens.focus_distance_mm {} puts the near face of the box at {} mm, within the focal length {} "
                    "mm: no real image; enlarge it or make seeding.volume_z_mm smaller",
                    lens.focus_distance_mm, nearest, lens.efl_mm));
  if (std::abs(lens.entrance_pupil_mm) >= lens.efl_mm)
    fail(fmt::format("main_lens.entrance_pupil_mm {} lies beyond the focal length {} mm: bring it nearer to H1",
                     lens.entrance_pupil_mm, lens.efl_mm));
  if (scenario.flow.wall_y_mm >= 0.5 * scenario.seeding.volume_y_mm)
    fail(fmt::format("flow.wall_y_mm {} is above the box, which ends at y = {} mm: no fluid is left; lower the wall",
                     scenario.flow.wall_y_mm, 0.5 * scenario.seeding.volume_y_mm));
}

}  // namespace rptv
