// SPDX-License-Identifier: MIT
// Names, ranges and docs of the detector's settings.
#include "reconstruct/detection/detector_settings.hpp"

namespace rptv {

void DetectorSettings::fields(FieldList& list) {
  list.texts("background_images", background_images,
             "images without particles, one a camera; empty: the constant background");
  list.number("background", background, 0, 65535, "grey level without light");
  list.number("threshold", threshold, 0, 65535, "a pixel is lit when it is more than this above its background");
  list.number("threshold_sigmas", threshold_sigmas, 0, 1000, "and more than this many of its own noise");
  list.flag("running_background", running_background,
            "background and noise of each pixel follow the images; starts from the one given");
  list.integer("background_frames", background_frames, 2, 100000,
               "images (times 16) that the running background looks back");
  list.choice("method", method, {"gaussian", "three_point", "centroid", "blob"},
              "fit of a Gaussian, three-point Gaussian, centre of light, or connected pixels with their ellipse");
  list.integer("radius_px", radius_px, 1, 3, "half-width of the square that tells the centre; blobs have none");
  list.number("split_sigmas", split_sigmas, 0, 1000,
              "two maxima are two particles when the grey between them falls by this many of its noise");
  list.integer("overlap_sweeps", overlap_sweeps, 0, 100,
               "gaussian: how often spots that overlap are fitted to what the others leave; 0: never");
  list.flag("find_hidden", find_hidden,
            "gaussian: where a spot is not what one Gaussian gives, put another one; for images that are all round");
  list.integer("max_overlapping", max_overlapping, 1, 1000000,
               "spots that overlap in a frame; where there are more, none is fitted so and all are counted");
  list.integer("min_area_px", min_area_px, 1, 1000000, "lit pixels that a particle image has at least");
  list.integer("max_area_px", max_area_px, 1, 1000000, "lit pixels that a blob has at most");
  list.number("saturation_grey", saturation_grey, 0, 65535,
              "from this grey value a pixel is saturated; 0: the highest that 8 or 16 bits hold");
  list.number("noise_grey", noise_grey, 0.01, 1e4, "rms of a dark pixel");
  list.number("electrons_per_grey", electrons_per_grey, 1e-3, 1e6, "gain of the camera: photoelectrons per grey level");
  list.integer("max_detections", max_detections, 1, 1000000,
               "particle images in a frame; more are counted as overflow");
}

}  // namespace rptv
