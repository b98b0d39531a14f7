// SPDX-License-Identifier: MIT
// A rig put right by the particles themselves: volume self-calibration (Wieneke 2008, Exp. Fluids 45).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calibration/cameras/camera_change.hpp"
#include "calibration/cameras/disparity_maps.hpp"
#include "calibration/cameras/rig.hpp"

namespace rptv {

/// The rig with cameras changed so that the disparities of `maps` vanish: in each part of the volume the mean particle
/// is a point that each camera sees where its projection is, less the peak of its map, and all cameras and points are
/// adjusted at once (Ceres), starting from `start`, whose cameras are `rig`'s as they were before any round. Particles
/// do not tell where the rig as a whole is (position, direction, and through air alone the scale): of all rigs that
/// serve, the one is taken whose cameras' changes from `start` have the smallest sum (in pixels, about), so that
/// cameras which did not move stay where most agree. `origin` stands before messages. Throws Error(bad_data) when a
/// camera has a peak in fewer than kLeastParts parts, or when the adjustment fails. Set-up only.
inline constexpr std::size_t kLeastParts = 6;
Rig corrected_rig(const Rig& rig, const Rig& start, const DisparityMaps& maps, CameraFreedom freedom,
                  const std::string& origin);

struct SelfCalibrationOptions {
  CameraFreedom freedom = CameraFreedom::pose;
  double search_px = 5;    ///< disparities looked for in the first round; a third of it in the next, and so on
  double finest_px = 1;    ///< but no less
  std::size_t rounds = 3;  ///< corrections
};

struct SelfCalibration {
  Rig rig;
  std::vector<CameraDisparity> before, after;  ///< of each camera
};

/// Adds the disparities of particles, triangulated by `rig`, up to maps.radius_px() to the empty `maps`.
using GatherDisparities = std::function<void(const Rig& rig, DisparityMaps& maps)>;

/// Gathers and corrects, round by round, and gathers once more for `after`. Where too few parts have a peak in the
/// first round, it is repeated with six tenths of the search, down to the finest. Throws Error(bad_data) as
/// corrected_rig() does, and when the worst camera is no better after than before; what `gather` throws goes through.
/// Set-up only.
SelfCalibration self_calibrate(const Rig& start, const DisparityGrid& grid, const SelfCalibrationOptions& options,
                               const GatherDisparities& gather, const std::string& origin);

}  // namespace rptv
