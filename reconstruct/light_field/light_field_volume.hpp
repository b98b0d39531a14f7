// SPDX-License-Identifier: MIT
// From settings and calibration to voxels, gates and limits; every contradiction between them is an error here.
#pragma once

#include <cstdint>

#include "calibration/light_field/light_field_calibration.hpp"
#include "reconstruct/light_field/explain_away.hpp"
#include "reconstruct/light_field/light_field_settings.hpp"
#include "reconstruct/light_field/ray_count_kernel.hpp"
#include "reconstruct/light_field/shake.hpp"

namespace rptv {

/// Throws Error(configuration) where one choice does not go with another.
void check_choices(const LightFieldSettings& settings);

/// The volume of the settings, in voxels. `slope_half_range` decides the planes that are counted: on the nearest one
/// the outermost ray is at most half a voxel off (coarse to fine) or an eighth (coarse). Throws Error(configuration).
VoxelGrid make_grid(const LightFieldSettings& settings, const LightFieldCalibration& calibration,
                    double slope_half_range);

/// C_min: settings.min_count, or eq. (7). Throws Error(configuration) when neither gives a count.
std::uint16_t make_min_count(const LightFieldSettings& settings, const LightFieldCalibration& calibration);

/// Gates and limits of fitting and explaining away.
ExplainOptions make_explain_options(const LightFieldSettings& settings, const LightFieldCalibration& calibration,
                                    const VoxelGrid& grid, std::uint16_t min_count);

/// The forward model and the limits of its fit.
ShakeOptions make_shake_options(const LightFieldSettings& settings, const LightFieldCalibration& calibration,
                                const ExplainOptions& explain);

}  // namespace rptv
