// SPDX-License-Identifier: MIT
// How well a calibrated rig places particles all over the volume: by their images, and by the calibration's own errors.
#pragma once

#include <optional>
#include <string>

#include "calibration/cameras/bundle_adjust.hpp"

namespace rptv {

inline constexpr double kParticle_px = 0.1;  ///< a particle's image is placed to about that

/// Standard errors along x, y, z over a volume, mm.
struct ErrorSpread {
  Point3 median_mm{}, worst_mm{};
};

/// Over a grid of 11³ places in the box that the target's points filled.
struct VolumeAccuracy {
  Point3 from_mm{}, to_mm{};  ///< the box, rig's frame
  double seen = 0;            ///< share of the grid that two or more cameras see
  ErrorSpread detection;      ///< expected_error_mm(): differs from particle to particle
  /// Of calibration_covariance_mm2(): the same for all particles at a place. `together`: the root of the sum of both
  /// squares at each place. `shape`: of the calibration's errors, less what shifts and turns the whole volume (least
  /// squares over the grid): errors of distances. None when the images do not determine the cameras.
  std::optional<ErrorSpread> calibration, together, shape;
};
VolumeAccuracy volume_accuracy(const BoardSet& set, const BundleResult& result, double sigma_px = kParticle_px);
/// The same for people, one line for each of the three.
std::string to_text(const VolumeAccuracy& volume, double sigma_px = kParticle_px);
/// One JSON object.
std::string to_json(const VolumeAccuracy& volume, double sigma_px = kParticle_px);
/// [x,y,z].
std::string json_point(const Point3& point);

}  // namespace rptv
