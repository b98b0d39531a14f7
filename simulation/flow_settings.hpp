// SPDX-License-Identifier: MIT
// What a simulated flow consists of: what moves the particles, and where they are.
#pragma once

#include <string>
#include <vector>

#include "core/settings.hpp"

namespace rptv {

/// What moves the particles. The lengths and rates here are those of the wall at y = wall_y_mm that oscillates along x;
/// fluid above it (y > wall_y_mm): Stokes' second problem plus a uniform drift.
struct FlowSettings {
  std::string kind =
      "oscillating_wall";  ///< or "duct", "waves", "layers" (still), "random" (new in every frame), "table"
  std::string table;       ///< points or tracks table of positions, frame by frame
  double wall_y_mm = -3.5;
  double wall_amplitude_mm = 0.3;  ///< displacement amplitude A of the wall; velocity amplitude U = A w
  double frequency_hz = 5.0;
  double stokes_layer_mm = 1.0;  ///< delta = sqrt(2 nu / w) = 1/k
  double drift_x_mm_s = 0.3;
  double drift_z_mm_s = 0.2;
  void fields(FieldList& list);
};

/// Laminar flow along x in a duct of width_mm (y) by height_mm (z), centred on the axis.
struct DuctSettings {
  double width_mm = 0.2, height_mm = 0.2;
  double flow_rate_ul_min = 0.85;  ///< positive: towards +x
  void fields(FieldList& list);
};

/// Waves that swing particles about places that drift: a flow in three dimensions with exact paths (wave_flow.hpp).
struct WavesSettings {
  double rms_mm = 1.5;      ///< of the swing, per coordinate
  double length_mm = 25.0;  ///< mean wavelength
  double rate_hz = 15.0;    ///< mean frequency
  void fields(FieldList& list);
};

/// Still layers of particles across the axis (the proposal's figure 6).
struct LayerSettings {
  std::vector<double> z_mm{8, 0, -8};  ///< object space, towards the lens
  std::int64_t particles_each = 15;
  void fields(FieldList& list);
};

/// Tracers without inertia, uniform in the lit box |x|, |y|, |z| <= volume/2 of object space.
struct SeedingSettings {
  std::int64_t particles = 200;      ///< mean number in the lit box
  double per_lenslet = 0;            ///< above 0: particles per lenslet of the box's image, in place of `particles`
  double particle_radius_um = 15.0;  ///< half the diameter of its image, divided by the magnification
  double volume_x_mm = 7.0, volume_y_mm = 7.0, volume_z_mm = 7.0;
  double photoelectrons = 40000.0;  ///< per particle and frame at z = 0, in the whole image
  bool equal_light = false;         ///< the same light from every depth; false: inverse square of the distance
  void fields(FieldList& list);
};

}  // namespace rptv
