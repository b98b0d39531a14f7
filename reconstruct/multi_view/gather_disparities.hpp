// SPDX-License-Identifier: MIT
// Disparities of all sets of detections that may be particles, true or not, for volume self-calibration.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calibration/cameras/disparity_maps.hpp"
#include "calibration/cameras/rig.hpp"
#include "reconstruct/detection/detections.hpp"
#include "reconstruct/multi_view/view_rays.hpp"

namespace rptv {

struct ParticleImage {
  Pixel at_px{};
  double grey = 0;  ///< light, any unit
};
/// Of one frame, a list per camera.
using ParticleImages = std::vector<std::vector<ParticleImage>>;

struct DisparitySearch {
  Volume volume;
  std::size_t min_views = 4;  ///< that must see a particle; fewer let more chance in
  /// Sets taken from a frame, which also bounds the time that it takes; a random part of its images is followed where
  /// there are more.
  std::size_t most_matches = 65536;
};

/// Triangulates every set of detections whose reprojection errors are within 1.1 maps.radius_px() and adds its
/// disparities. No set is chosen over another: that would prefer small disparities (Wieneke 2008). Where images lie so
/// close that chance would drown the true sets, only the brightest of each view are taken: 0.03 / radius^1.25 a square
/// pixel (radius in px) of the box that they fill. Returns how many sets were added. Throws Error(configuration) as
/// ViewRays and Correspondence do. Set-up only.
std::uint64_t gather_disparities(const Rig& rig, const DisparitySearch& search, std::span<const ParticleImages> frames,
                                 DisparityMaps& maps);

/// Detections as they are given to gather_disparities().
ParticleImages images_of(std::span<const Detections> seen);

}  // namespace rptv
