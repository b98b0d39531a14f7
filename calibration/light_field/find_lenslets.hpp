// SPDX-License-Identifier: MIT
// Sub-images in a white image (or a projection of particle images), the lattice through the intact ones, and the rest.
#pragma once

#include <string>
#include <vector>

#include "calibration/grey_image.hpp"
#include "calibration/light_field/lattice_fit.hpp"
#include "calibration/light_field/lenslet_mask.hpp"
#include "calibration/light_field/light_field_calibration.hpp"

namespace rptv {

/// One sub-image and why it was left out (lenslet_reason bits; 0: it was used).
struct FoundSpot {
  int u = 0, v = 0;
  double x_px = 0, y_px = 0;                      ///< measured: column, row; where the mean sub-image fits best
  double centroid_x_px = 0, centroid_y_px = 0;    ///< of its light, which is elsewhere when a rim cuts it
  double predicted_x_px = 0, predicted_y_px = 0;  ///< by the lattice
  double light = 0;                               ///< over that of the sub-images on the axis
  double area = 0, axis_ratio = 0;                ///< over those on the axis, and short over long; means of neighbours
  bool matched = false;
  std::uint8_t reason = 0;
};

struct FoundLenslets {
  LatticeFit fit;                  ///< of the apparent lattice
  std::vector<FoundSpot> spots;    ///< every lenslet whose cell lies on the sensor
  double peak_significance = 0;    ///< of the spectrum
  double diameter_px = 0;          ///< of a sub-image at half its height
  bool overlapping = false;        ///< sub-images overlap: bright places are borders, found through the f-number
  bool distortion_unsure = false;  ///< there is a distortion, but intact sub-images do not reach far enough to fit it
  double intact_radius_px = 0;     ///< the farthest intact sub-image from the axis
  double field_radius_px = 0;      ///< the farthest lenslet
};

struct FindOptions {
  std::string origin;            ///< name of the image in messages
  bool particle_images = false;  ///< a projection of particle images: sub-images are filled in patches
  double dark_level = 0;         ///< grey value without light
  double apparent_scale = 0;     ///< apparent over true pitch when the exit pupil is known; 0: unknown
};

/// `start`: the data sheet (sensor, pitch, shape, focal length, f-number); its offset and rotation are not used. Throws
/// Error(bad_data) that says why the image does not support a calibration. Set-up only; some seconds.
FoundLenslets find_lenslets(const GreyImage& image, const LightFieldCalibration& start, const FindOptions& options);

}  // namespace rptv
