// SPDX-License-Identifier: MIT
// How well a rig places points: by the geometry of its rays, and on the target's own points.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calibration/cameras/bundle_adjust.hpp"

namespace rptv {

/// A camera's sight of one point.
struct Sighting {
  const CameraModel* camera = nullptr;
  Pixel pixel{};
};

/// The point that fits two or more sightings best (Gauss-Newton on the distances in the images, from the point nearest
/// to the rays). None when rays are parallel or it runs away.
std::optional<Point3> triangulate(std::span<const Sighting> sightings);

/// Standard errors along x, y, z, mm, of a point that each camera which sees it places to `sigma_px` per coordinate:
/// the roots of the diagonal of sigma²·(sum of JᵀJ)⁻¹. None when fewer than two cameras see it.
std::optional<Point3> expected_error_mm(std::span<const CameraModel> cameras, const Point3& point_mm, double sigma_px);

/// Points of the target, triangulated from the images, against where the bundle has them.
struct TargetErrors {
  std::size_t points = 0;  ///< seen by two or more cameras
  double rms_mm = 0, largest_mm = 0;
};
TargetErrors target_errors(const BoardSet& set, const BundleResult& result);

/// The cameras of a bundle.
std::vector<CameraModel> models_of(const Bundle& bundle);

}  // namespace rptv
