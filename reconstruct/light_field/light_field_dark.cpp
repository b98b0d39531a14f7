// SPDX-License-Identifier: MIT
// What the calibration's arrays do to the thresholds.
#include "reconstruct/light_field/light_field_dark.hpp"

#include <algorithm>
#include <utility>

#include "reconstruct/light_field/calibrated_pixels.hpp"

namespace rptv {

namespace {

constexpr double kLeastShare = 0.05;

// Where no noise was measured, the settings' keeps thresholds from falling into it.
double least_share(const LightFieldSettings& settings, const LightFieldCalibration& calibration) {
  if (!calibration.arrays.dark_noise.empty() || !(settings.threshold > 0)) return kLeastShare;
  return std::max(kLeastShare, settings.threshold_sigmas * settings.noise_grey / settings.threshold);
}

}  // namespace

LightFieldDark::LightFieldDark(const LightFieldSettings& settings, const LightFieldCalibration& calibration,
                               const LensletLattice& lattice, const ImageShape& shape, const ImageView& background)
    : fixed_{{}, DarkLimit(ImageShape{}, 0, 0)} {
  CalibratedPixels known = calibrated_pixels(calibration, lattice, least_share(settings, calibration));
  fixed_ = make_dark({settings.background, settings.threshold, settings.background_image, settings.threshold_sigmas},
                     shape, background, known.view());
  if (!settings.running_background) return;
  const bool pixel_by_pixel = background.data != nullptr || (!known.level.empty() && !(settings.background > 0));
  learner_ =
      std::make_unique<RunningBackground>(shape, fixed_, settings.noise_grey, pixel_by_pixel,
                                          RunningBackgroundOptions{settings.threshold, settings.threshold_sigmas,
                                                                   settings.background_frames, std::move(known.share)});
}

}  // namespace rptv
