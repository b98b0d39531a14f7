// SPDX-License-Identifier: MIT
// What every reconstruction from several views is set up from: cameras of the source, their part of the rig, the
// volume.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "calibration/cameras/rig.hpp"
#include "core/image.hpp"
#include "reconstruct/multi_view/correspondence.hpp"
#include "reconstruct/multi_view/multi_view_settings.hpp"
#include "reconstruct/multi_view/view_rays.hpp"

namespace rptv {

/// A camera of the source: what frames call it, and their shape. `background`: an image without particles, or no data.
struct MultiViewCamera {
  std::string name;
  ImageShape shape;
  ImageView background;
};

/// The rig's cameras that the source has, in the source's order. Throws Error(configuration) for a camera that the rig
/// has not, images of another size, and fewer than settings.min_views.
Rig choose_cameras(const MultiViewSettings& settings, const Rig& rig, std::span<const MultiViewCamera> cameras);

/// The box that the settings give; axes that are left empty are what min_views cameras see. Throws
/// Error(configuration).
Volume choose_volume(const MultiViewSettings& settings, const Rig& rig);

/// How particle images are matched at first, by so many threads.
CorrespondenceOptions matching_of(const MultiViewSettings& settings, std::size_t threads);

/// Sight rays of every camera. Throws Error(configuration) for one that does not look into the volume.
std::vector<ViewRays> trace_views(const Rig& rig, const Volume& volume);

}  // namespace rptv
