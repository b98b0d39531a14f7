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

/// Triangulates every set of detections whose reprojection errors are within 1.1 maps.radius_px() and adds the
/// disparities of those that agree within their part (agreeing_sets). No set is chosen for being small: that would hide
/// what is sought (Wieneke 2008). Where images lie close, only the brightest of each view are taken: 0.04 /
/// radius^1.25 a square pixel (radius in px) of the box that they fill. Returns how many sets were added. Throws
/// Error(configuration) as ViewRays and Correspondence do. Set-up only.
std::uint64_t gather_disparities(const Rig& rig, const DisparitySearch& search, std::span<const ParticleImages> frames,
                                 DisparityMaps& maps);
/// The same by sight rays of `search.volume` that were traced before.
std::uint64_t gather_disparities(const Rig& rig, std::span<const ViewRays> rays, const DisparitySearch& search,
                                 std::span<const ParticleImages> frames, DisparityMaps& maps);

/// Detections as they are given to gather_disparities().
ParticleImages images_of(std::span<const Detections> seen);

}  // namespace rptv
