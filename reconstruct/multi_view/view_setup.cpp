// SPDX-License-Identifier: MIT
// Names matched, boxes checked, rays traced.
#include "reconstruct/multi_view/view_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/error.hpp"
#include "reconstruct/multi_view/seen_volume.hpp"

namespace rptv {

Rig choose_cameras(const MultiViewSettings& settings, const Rig& rig, std::span<const MultiViewCamera> cameras) {
  if (cameras.size() < static_cast<std::size_t>(settings.min_views))
    throw Error(ExitCode::configuration,
                fmt::format("multi_view.min_views = {} and the source has {} camera{}; add cameras, or lower it",
                            settings.min_views, cameras.size(), cameras.size() == 1 ? "" : "s"));
  Rig chosen;
  for (const MultiViewCamera& camera : cameras) {
    const auto found = std::find_if(rig.cameras.begin(), rig.cameras.end(),
                                    [&](const RigCamera& candidate) { return candidate.name == camera.name; });
    if (found == rig.cameras.end()) {
      std::string names;
      for (const RigCamera& known : rig.cameras) names += (names.empty() ? "'" : ", '") + known.name + "'";
      throw Error(ExitCode::configuration, fmt::format("{}: has no camera '{}' (it has {}); name its cameras as the "
                                                       "source does",
                                                       settings.rig, camera.name, names));
    }
    check_resolution(*found, static_cast<int>(camera.shape.width_px), static_cast<int>(camera.shape.height_px),
                     settings.rig);
    chosen.cameras.push_back(*found);
  }
  return chosen;
}

Volume choose_volume(const MultiViewSettings& settings, const Rig& rig) {
  const std::vector<double>* given[]{&settings.volume_x_mm, &settings.volume_y_mm, &settings.volume_z_mm};
  const bool all = std::all_of(std::begin(given), std::end(given), [](const auto* range) { return !range->empty(); });
  Volume volume = all ? Volume{} : seen_volume(rig, static_cast<std::size_t>(settings.min_views));
  for (std::size_t k = 0; k < 3; ++k) {
    if (given[k]->empty()) continue;
    if (given[k]->size() != 2 || !((*given[k])[0] < (*given[k])[1]))
      throw Error(ExitCode::configuration, fmt::format("multi_view.volume_{}_mm is not [from, to] with from < to; "
                                                       "correct it, or leave it empty",
                                                       "xyz"[k]));
    volume.from[k] = (*given[k])[0], volume.to[k] = (*given[k])[1];
  }
  return volume;
}

CorrespondenceOptions matching_of(const MultiViewSettings& settings, std::size_t threads) {
  return {static_cast<std::size_t>(settings.min_views), settings.tolerance_px,
          static_cast<std::size_t>(settings.detector.max_detections), static_cast<std::size_t>(settings.max_matches),
          threads};
}

std::vector<ViewRays> trace_views(const Rig& rig, const Volume& volume) {
  std::vector<ViewRays> rays;
  for (const RigCamera& camera : rig.cameras) rays.emplace_back(camera.model, volume, camera.name);
  return rays;
}

}  // namespace rptv
