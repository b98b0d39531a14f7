// SPDX-License-Identifier: MIT
// A ray of light. Host and device.
#pragma once

namespace rptv {

/// Image space, mm: the ray is at (centre_x + slope_x·z, centre_y + slope_y·z) at depth z (z towards the main lens).
struct Ray {
  float centre_x, centre_y;  ///< true centre of its lenslet
  float slope_x, slope_y;    ///< (centre - pixel)/f
};

}  // namespace rptv
