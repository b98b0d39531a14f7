// SPDX-License-Identifier: MIT
// What a calibration knows per lenslet and per pixel, as HDF5: masks with reasons, vignetting, dark level and noise.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "calibration/light_field/lenslet_mask.hpp"

namespace rptv {

/// All lenslet arrays have the grid of `ray`; pixel arrays are row by row, empty when no dark image was given.
struct CalibrationArrays {
  LensletMask fit;                ///< why a sub-image was left out of the fit; such a lenslet may give good rays
  LensletMask ray;                ///< why a lenslet gives no rays
  std::vector<float> vignetting;  ///< light through the lenslet over that of those on the axis; 0 where unknown
  std::vector<float> area;        ///< of its sub-image over that of those on the axis; 0 where unknown
  std::uint32_t width_px = 0, height_px = 0;
  std::vector<float> dark_level;  ///< grey value without light
  std::vector<float> dark_noise;  ///< its rms over frames, grey values
};

/// Datasets `fit_reason`, `ray_reason`, `vignetting`, `area` (2D, row v by column u, attributes first_u and first_v),
/// `dark_level` and `dark_noise` (2D, image row by column), each with an attribute `units`. Replaces the file. Throws
/// Error(io or permission).
void write_calibration_arrays(const CalibrationArrays& arrays, const std::filesystem::path& file);

/// `ray_reason` and those of the others that are there. Throws Error(no_input or bad_data) naming file and dataset.
/// Set-up only; one thread.
CalibrationArrays read_calibration_arrays(const std::filesystem::path& file);

}  // namespace rptv
