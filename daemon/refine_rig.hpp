// SPDX-License-Identifier: MIT
// Volume self-calibration from recorded images: detect, search, correct.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "calibration/cameras/self_calibration.hpp"
#include "daemon/config.hpp"

namespace rptv {

struct RefineOptions {
  SelfCalibrationOptions self_calibration;
  std::array<std::size_t, 3> parts{4, 3, 2};  ///< of the volume, along x, y, z
  std::size_t frames = 50;                    ///< instants to look at, spread over the recording
};

struct RefinedRig {
  Rig rig;                         ///< all cameras of multi_view.rig; those without images as they were
  std::vector<std::size_t> place;  ///< in the rig, of each camera with images
  SelfCalibration found;           ///< of the cameras with images
  std::size_t instants = 0;        ///< looked at
};

/// Particle images in replay.path by [multi_view], its rig corrected. Throws Error as make_reconstructor() and
/// self_calibrate() do, and (bad_data) for fewer than three cameras.
RefinedRig refine_rig(const Config& config, const RefineOptions& options);

}  // namespace rptv
