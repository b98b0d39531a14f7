// SPDX-License-Identifier: MIT
// Images of several cameras, instant by instant, through the multi-view stage.
#include "daemon/commands/reconstruct_views.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <iostream>

#include "core/tables.hpp"
#include "daemon/backend.hpp"
#include "daemon/blind_views.hpp"
#include "daemon/first_instant.hpp"
#include "daemon/instants.hpp"
#include "daemon/progress.hpp"
#include "daemon/session.hpp"
#include "reconstruct/multi_view/iterative_views.hpp"
#include "reconstruct/multi_view/multi_view.hpp"
#include "replay/image_sequence.hpp"
#include "replay/timeline.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;

/// What both kinds of counts have.
template <class Counts>
void tell_frames(const Counts& n, std::size_t instants, std::uint64_t particles) {
  std::cerr << fmt::format("reconstructed {} of {} instants: {} particles\n", n.frames, instants, particles);
  if (n.refused_views > 0)
    std::cerr << fmt::format("{} images were missing or unusable; {} instants had too few views\n", n.refused_views,
                             n.too_few_views);
  if (n.refused_particles > 0)
    std::cerr << fmt::format("{} particles were left out: raise multi_view.max_particles\n", n.refused_particles);
}

void tell_detections(std::uint64_t refused) {
  if (refused > 0)
    std::cerr << fmt::format(
        "{} particle images were left out: raise multi_view.detector.threshold or "
        "multi_view.detector.max_detections\n",
        refused);
}

void tell_matches(const CorrespondenceCounts& n, const char* tolerance) {
  if (n.refused_matches + n.unsearched > 0)
    std::cerr << fmt::format(
        "{} sets of particle images were left out, {} rays were not followed: lower "
        "multi_view.{} or raise multi_view.max_matches\n",
        n.refused_matches, n.unsearched, tolerance);
}

void tell(const Reconstructor& stage, std::size_t instants, std::uint64_t particles) {
  if (const auto* iterative = dynamic_cast<const IterativeViews*>(&stage)) {
    tell_frames(iterative->counts(), instants, particles);
    if (const std::uint64_t places = iterative->counts().refused_places; places > 0)
      std::cerr << fmt::format("{} places of particles were left out: raise multi_view.max_particles\n", places);
    tell_detections(iterative->counts().refused_peaks);
    tell_matches(iterative->correspondence_counts(), "iterative.tolerance_px");
    return;
  }
  const auto& once = dynamic_cast<const MultiView&>(stage);
  tell_frames(once.counts(), instants, particles);
  tell_detections(once.counts().refused_detections);
  tell_matches(once.correspondence_counts(), "tolerance_px");
}

void tell_blind(const BlindViewCounter& counter, const std::vector<ImageSequence>& cameras) {
  for (std::size_t c = 0; c < cameras.size(); ++c)
    if (counter.blind(c) > 0)
      std::cerr << fmt::format("warning: {}; in {} of {} instants, first at frame {}\n",
                               blind_warning(cameras[c].camera()), counter.blind(c), counter.seen(), counter.first(c));
}

}  // namespace

ExitCode reconstruct_views(const Config& config, const std::string& output) {
  const auto cameras = open_cameras(config.replay.path, config.replay.pattern);
  const bool timed = config.replay.rate_hz > 0 || fs::exists(fs::path(config.replay.path) / "frames.csv");
  const Timeline timeline = make_timeline(config.replay.path, cameras, timed ? config.replay.rate_hz : 1, -1);
  std::string where;
  const auto stage = make_reconstructor(config, infos_of(cameras), &where);
  std::cerr << where << '\n';
  for (const std::string& doubt : doubts_of_first_instant(config)) std::cerr << "warning: " << doubt << '\n';
  PointsWriter points(output, {.covariance = true, .ghost = true, .time = timed});
  Particles particles(config.max_particles());
  Instants instants(cameras);
  BlindViewCounter blind(cameras.size());
  dynamic_cast<ObservableViews&>(*stage).show_to(&blind);
  std::uint64_t total = 0;
  Progress progress("reconstructing", timeline.instants());
  for (std::size_t i = 0; i < timeline.instants(); ++i, progress.advance()) {
    const FrameSet& frames = instants.load(timeline, i);
    blind.begin(timeline.index[i], frames);
    stage->reconstruct(frames, particles);
    const double t_s = timed ? static_cast<double>(timeline.shots.front()[i].time_ns) * 1e-9 : kNoTime;
    points.write(timeline.index[i], t_s, particles);
    total += particles.size();
  }
  points.close();
  tell(*stage, timeline.instants(), total);
  if (stage->sets_without_device() > 0) std::cerr << device_failure(stage->sets_without_device()) << '\n';
  tell_blind(blind, cameras);
  return ExitCode::ok;
}

}  // namespace rptv
