// SPDX-License-Identifier: MIT
// The polynomial map from image to object space through points known in both, and how well it and other maps do.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "calibration/light_field/correspondences.hpp"
#include "calibration/light_field/object_map.hpp"

namespace rptv {

/// Distances between mapped and known points of object space, mm.
struct VolumeResiduals {
  Point3 rms{};                  ///< per axis
  double mean = 0, largest = 0;  ///< of the distance
  std::size_t worst = 0;         ///< which point is the farthest off
};
VolumeResiduals residuals_of(const ObjectMap& map, std::span<const Correspondence> pairs);

struct VolumeFit {
  LightFieldCalibration calibration;  ///< `start` with lens.model = "polynomial"
  VolumeResiduals residuals;
  Point3 left_out_rms{};  ///< per axis, of each point by the polynomial through the others: what new points will have
  double condition = 0;   ///< of the scaled equations
};

/// Least squares for the 19 factors of each axis, in the box of the points, after the lens of `start` (a polynomial
/// that it has already is replaced). Throws Error(bad_data) when the points do not fix them: fewer than 25, or on fewer
/// than 3 depths, 4 rows or 4 columns. `origin` names the table in messages.
VolumeFit fit_volume(std::span<const Correspondence> pairs, const LightFieldCalibration& start,
                     const std::string& origin);

}  // namespace rptv
