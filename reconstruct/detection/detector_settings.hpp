// SPDX-License-Identifier: MIT
// What a user can choose about finding particle images in a camera's frames; all of it fixed when the stage is built.
#pragma once

#include <string>
#include <vector>

#include "core/settings.hpp"

namespace rptv {

/// Of one or of all cameras of a rig. Grey values are those of the images.
struct DetectorSettings {
  std::vector<std::string> background_images;  ///< paths of images without particles, one a camera; empty: `background`
  double background = 0;                       ///< grey level without light
  double threshold = 20;                       ///< a pixel is lit when it is more than this above its background
  double threshold_sigmas = 6;                 ///< and more than this many of its noise
  bool running_background = false;             ///< background and noise of each pixel follow the images
  std::int64_t background_frames = 100;        ///< how many images (times 16) the running background looks back

  std::string method = "gaussian";  ///< how the centre is found: "gaussian", "three_point", "centroid", "blob"
  std::int64_t radius_px = 2;       ///< half-width of the square round a maximum that tells its centre; not of blobs
  double split_sigmas = 4;          ///< two maxima are two particles when the grey falls by this many of its noise
  std::int64_t overlap_sweeps = 6;  ///< "gaussian": fits of spots that overlap to what the others leave; 0: none
  bool find_hidden = false;         ///< look for spots that hide in another's image; where all are round
  std::int64_t max_overlapping = 4096;  ///< spots of a frame that are untangled so; bounds its time
  std::int64_t min_area_px = 3;         ///< lit pixels of a particle image
  std::int64_t max_area_px = 10000;     ///< lit pixels of a blob
  double saturation_grey = 0;           ///< from here a pixel tells nothing; 0: the highest that 8 or 16 bits hold
  double noise_grey = 1;                ///< rms of a dark pixel
  double electrons_per_grey = 4;        ///< gain of the camera: the shot noise of light
  std::int64_t max_detections = 16384;

  void fields(FieldList& list);
};

}  // namespace rptv
