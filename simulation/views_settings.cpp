// SPDX-License-Identifier: MIT
// The fields of a simulated rig.
#include "simulation/views_settings.hpp"

namespace rptv {

void ViewsSettings::fields(FieldList& list) {
  list.text("rig", rig,
            "cameras in place of the light-field one: 'lpt_challenge', or a rig file (TOML); empty: a light field");
  list.number("sensor_part", sensor_part, 0.01, 1,
              "lpt_challenge: part of the sensor's width and height and of the box's x and y that is simulated");
  list.number("per_pixel", per_pixel, 0, 1, "above 0: particles per pixel of a sensor, in place of seeding.particles");
  list.number("sigma_px", sigma_px, 0.1, 10, "standard deviation of a particle's Gaussian image, px");
}

}  // namespace rptv
