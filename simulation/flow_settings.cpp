// SPDX-License-Identifier: MIT
// The fields of flow and seeding.
#include "simulation/flow_settings.hpp"

namespace rptv {

void FlowSettings::fields(FieldList& list) {
  list.choice(
      "kind", kind, {"oscillating_wall", "duct", "waves", "layers", "random", "table"},
      "what moves the particles: the wall below, [duct], [waves], nothing ([layers]), chance, or a table of positions");
  list.text("table", table, "kind table: points or tracks (CSV) of every frame, object space, mm");
  list.number("wall_y_mm", wall_y_mm, -1e3, 1e3, "height of the wall, mm; the fluid is above it");
  list.number("wall_amplitude_mm", wall_amplitude_mm, 0, 1e2, "displacement amplitude of the wall along x, mm");
  list.number("frequency_hz", frequency_hz, 1e-3, 1e5, "frequency of the wall, Hz");
  list.number("stokes_layer_mm", stokes_layer_mm, 1e-3, 1e3, "Stokes layer thickness sqrt(2 nu / omega), mm");
  list.number("drift_x_mm_s", drift_x_mm_s, -1e4, 1e4, "uniform drift along x, mm/s");
  list.number("drift_z_mm_s", drift_z_mm_s, -1e4, 1e4, "uniform drift along z (towards the lens), mm/s");
}

void DuctSettings::fields(FieldList& list) {
  list.number("width_mm", width_mm, 1e-3, 1e3, "inner width along y, mm");
  list.number("height_mm", height_mm, 1e-3, 1e3, "inner height along z, mm");
  list.number("flow_rate_ul_min", flow_rate_ul_min, -1e9, 1e9, "flow rate towards +x, ul/min");
}

void WavesSettings::fields(FieldList& list) {
  list.number("rms_mm", rms_mm, 0, 1e3, "swing of a particle, root mean square per coordinate, mm");
  list.number("length_mm", length_mm, 1e-3, 1e5, "mean wavelength, mm");
  list.number("rate_hz", rate_hz, 0, 1e5, "mean frequency, Hz");
}

void LayerSettings::fields(FieldList& list) {
  list.numbers("z_mm", z_mm, 0, -1e3, 1e3, "height of each layer over the focused plane, towards the lens, mm");
  list.integer("particles_each", particles_each, 1, 100000, "particles in each layer, spread over volume_x and _y");
}

void SeedingSettings::fields(FieldList& list) {
  list.integer("particles", particles, 0, 1000000, "mean number of particles in the lit box");
  list.number("per_lenslet", per_lenslet, 0, 100,
              "above 0: particles per lenslet that the box's image covers, in place of particles");
  list.number("particle_radius_um", particle_radius_um, 0, 1e3, "radius of a particle, um");
  list.number("volume_x_mm", volume_x_mm, 1e-3, 1e3, "lit box along x, centred on the axis, mm");
  list.number("volume_y_mm", volume_y_mm, 1e-3, 1e3, "lit box along y, mm");
  list.number("volume_z_mm", volume_z_mm, 1e-3, 1e3, "lit box along z, centred on the focused plane, mm");
  list.number("photoelectrons", photoelectrons, 0, 1e7, "photoelectrons per particle and frame at z = 0");
  list.flag("equal_light", equal_light, "the same light from every depth, not by the inverse square of the distance");
}

}  // namespace rptv
