// SPDX-License-Identifier: MIT
// What a simulated rig of several cameras consists of, besides the particles and the sensor's noise.
#pragma once

#include <string>

#include "core/settings.hpp"

namespace rptv {

/// Several cameras in place of one light-field camera; with them the sections main_lens and lenslets do not count, and
/// camera's width, height and pixel come from the rig.
struct ViewsSettings {
  std::string rig;         ///< empty: a light-field camera; "lpt_challenge", or a rig file (TOML)
  double sensor_part = 1;  ///< lpt_challenge: part of the sensor's width and height, and of the box's x and y
  double per_pixel = 0;    ///< above 0: particles per pixel of a sensor, in place of seeding.particles
  double sigma_px = 0.8;   ///< of a particle's Gaussian image
  void fields(FieldList& list);
};

}  // namespace rptv
