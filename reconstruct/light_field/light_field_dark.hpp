// SPDX-License-Identifier: MIT
// Background and thresholds of a light-field camera: as settings and calibration say, or learned from the images.
#pragma once

#include <memory>

#include "calibration/light_field/lenslet_lattice.hpp"
#include "reconstruct/light_field/light_field_settings.hpp"
#include "reconstruct/running_background.hpp"

namespace rptv {

/// Where the calibration has arrays, a pixel is lit by its own measure: the threshold shrinks with the light that its
/// lenslet lets through, and is no less than settings.threshold_sigmas of the pixel's noise. One thread.
class LightFieldDark {
 public:
  /// Throws Error(configuration) as make_dark() does.
  LightFieldDark(const LightFieldSettings& settings, const LightFieldCalibration& calibration,
                 const LensletLattice& lattice, const ImageShape& shape, const ImageView& background);

  const DarkPixels& now() const noexcept { return learner_ ? learner_->dark() : fixed_; }
  /// How much brighter than its mean the brightest dark value of a pixel is, grey values.
  float threshold_of(std::uint32_t pixel) const noexcept {
    return static_cast<float>(now().limit.limits()[pixel]) - now().mean[pixel];
  }
  /// They change from frame to frame.
  bool follows() const noexcept { return learner_ != nullptr; }
  /// Before a frame: takes what has been learned. After it: gives it to be learned from.
  void refresh() noexcept {
    if (learner_) learner_->refresh();
  }
  void offer(const ImageView& image) noexcept {
    if (learner_) learner_->offer(image);
  }

 private:
  DarkPixels fixed_;                            // at the start
  std::unique_ptr<RunningBackground> learner_;  // with settings.running_background
};

}  // namespace rptv
