// SPDX-License-Identifier: MIT
// From images of the lenslet array to a light-field calibration with its arrays, or a refusal that says why not.
#pragma once

#include <cstdint>
#include <string>

#include "calibration/light_field/calibration_arrays.hpp"
#include "calibration/light_field/find_lenslets.hpp"
#include "calibration/light_field/image_statistics.hpp"

namespace rptv {

struct LensletImages {
  std::string origin;      ///< name of the images in messages
  ImageStatistics images;  ///< white images, or particle images
  bool particle_images = false;
  std::uint32_t significant_bits = 16;
  ImageStatistics dark;  ///< may be empty
};

/// What is known before: the exit pupil, or the pitch.
struct LensletKnowledge {
  bool exit_pupil_known = false;  ///< start.lens.exit_pupil_mm holds (0: telecentric), the pitch is fitted
};

struct LensletCalibrationResult {
  LightFieldCalibration calibration;
  CalibrationArrays arrays;
  FoundLenslets found;
  double sheet_pitch_um = 0;       ///< of the data sheet
  double exit_pupil_sigma_mm = 0;  ///< from the scatter of the spots alone; 0 when the exit pupil was given
  bool exit_pupil_fitted = false;
};

/// `start`: the data sheet and the lens; see find_lenslets(). Throws Error(bad_data) when the images do not support a
/// calibration: saturated, empty, no lattice, another pitch, overlap that cannot be resolved. Set-up only.
LensletCalibrationResult calibrate_lenslets(const LensletImages& images, const LightFieldCalibration& start,
                                            const LensletKnowledge& known);

/// Splits the apparent lattice into true lattice and exit pupil about the optical axis: spot = centre·(1 + f/D). Either
/// D is known and the pitch follows, or the pitch is and D does. Throws Error(bad_data) when neither is plausible.
LensletCalibrationResult separate_lattices(const FoundLenslets& found, const LightFieldCalibration& start,
                                           const LensletKnowledge& known, const std::string& origin);

}  // namespace rptv
