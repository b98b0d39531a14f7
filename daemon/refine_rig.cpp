// SPDX-License-Identifier: MIT
// Joins detection, correspondence and self-calibration.
#include "daemon/refine_rig.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/error.hpp"
#include "daemon/instants.hpp"
#include "daemon/progress.hpp"
#include "daemon/session.hpp"
#include "reconstruct/multi_view/gather_disparities.hpp"
#include "reconstruct/multi_view/multi_view.hpp"

namespace rptv {
namespace {

constexpr std::size_t kLeastCameras = 3;   // two disagree across their epipolar lines only
constexpr std::size_t kSearchedViews = 4;  // more lose the particles that one camera misses

struct SeenParticles {
  Volume volume;
  std::vector<ParticleImages> frames;
};

SeenParticles look(const Config& config, const std::vector<ImageSequence>& cameras, const RefineOptions& options) {
  const bool timed =
      config.replay.rate_hz > 0 || std::filesystem::exists(std::filesystem::path(config.replay.path) / "frames.csv");
  const Timeline timeline = make_timeline(config.replay.path, cameras, timed ? config.replay.rate_hz : 1, -1);
  const auto stage = make_reconstructor(config, infos_of(cameras));
  auto& multi_view = dynamic_cast<MultiView&>(*stage);
  Particles particles(config.max_particles());
  Instants instants(cameras);
  SeenParticles seen{multi_view.volume(), {}};
  const std::size_t count = std::min(options.frames, timeline.instants());
  Progress progress("detecting", count);
  for (std::size_t i = 0; i < count; ++i, progress.advance()) {
    multi_view.reconstruct(instants.load(timeline, i * timeline.instants() / count), particles);
    seen.frames.push_back(images_of(multi_view.detections()));
  }
  return seen;
}

std::vector<std::size_t> places_in(const Rig& rig, const std::vector<ImageSequence>& cameras) {
  std::vector<std::size_t> places;
  for (const ImageSequence& camera : cameras) {
    const auto at = std::find_if(rig.cameras.begin(), rig.cameras.end(),
                                 [&](const RigCamera& known) { return known.name == camera.camera(); });
    places.push_back(static_cast<std::size_t>(at - rig.cameras.begin()));  // there: MultiView has found them, too
  }
  return places;
}

}  // namespace

RefinedRig refine_rig(const Config& config, const RefineOptions& options) {
  const auto cameras = open_cameras(config.replay.path, config.replay.pattern);
  if (cameras.size() < kLeastCameras)
    throw Error(ExitCode::bad_data,
                fmt::format("{}: has images of {} camera{} and particles tell of {} or more; "
                            "calibrate with a target or a rod",
                            config.replay.path, cameras.size(), cameras.size() == 1 ? "" : "s", kLeastCameras));
  const SeenParticles seen = look(config, cameras, options);
  RefinedRig refined{read_rig(config.multi_view.rig), {}, {}, seen.frames.size()};
  refined.place = places_in(refined.rig, cameras);
  Rig start;
  for (const std::size_t place : refined.place) start.cameras.push_back(refined.rig.cameras[place]);
  const DisparitySearch search{seen.volume, std::min(cameras.size(), kSearchedViews)};
  Progress progress("searching", options.self_calibration.rounds + 1);
  const auto gather = [&](const Rig& rig, DisparityMaps& maps) {
    gather_disparities(rig, search, seen.frames, maps);
    progress.advance();
  };
  refined.found = self_calibrate(start, {seen.volume.from, seen.volume.to, options.parts}, options.self_calibration,
                                 gather, config.multi_view.rig);
  for (std::size_t c = 0; c < refined.place.size(); ++c)
    refined.rig.cameras[refined.place[c]] = refined.found.rig.cameras[c];
  return refined;
}

}  // namespace rptv
