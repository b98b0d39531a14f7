// SPDX-License-Identifier: MIT
// The painted scene and the settings that the tests of the whole light-field stage share.
#pragma once

#include "core/particles.hpp"
#include "reconstruct/light_field/light_field_settings.hpp"
#include "tests/reconstruct/light_field/painted_image.hpp"

namespace rptv::testing {

inline constexpr double kRadiusMm = 0.0375;  // 15 um at 2.5x

inline LightFieldSettings small_settings() {
  LightFieldSettings settings;
  settings.threshold = 50;
  settings.particle_radius_um = 15;
  settings.volume_z_mm = {-24, 14};
  settings.space = "image";
  settings.max_rays = 65536;
  settings.max_particles = 512;
  return settings;
}

inline std::vector<ImageParticle> scene(unsigned seed) { return scatter(25, 1.6, 1.1, -20, 10, 0.35, seed); }

inline PaintedImage paint(const std::vector<ImageParticle>& particles) {
  PaintedImage image(small_camera());
  for (const auto& p : particles) image.paint(p, kRadiusMm);
  return image;
}

// Index of the found particle nearest to a true one, if it is within the limits; -1 otherwise.
inline int nearest(const Particles& found, const ImageParticle& p) {
  int best = -1;
  double least = 1;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double distance =
        std::hypot((found.x_mm[i] - p.x) / 0.1, (found.y_mm[i] - p.y) / 0.1, (found.z_mm[i] - p.z) / 2);
    if (distance < least) least = distance, best = static_cast<int>(i);
  }
  return best;
}

}  // namespace rptv::testing
