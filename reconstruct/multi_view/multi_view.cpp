// SPDX-License-Identifier: MIT
// The multi-view chain, one step a line.
#include "reconstruct/multi_view/multi_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "reconstruct/detection/detector.hpp"
#include "reconstruct/multi_view/chance_of_match.hpp"
#include "reconstruct/multi_view/seen_volume.hpp"
#include "reconstruct/multi_view/view_fit.hpp"
#include "reconstruct/multi_view/view_ghosts.hpp"
#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {

/// The rig's cameras that the source has, in the source's order.
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

std::vector<ViewRays> trace(const Rig& rig, const Volume& volume) {
  std::vector<ViewRays> rays;
  for (const RigCamera& camera : rig.cameras) rays.emplace_back(camera.model, volume, camera.name);
  return rays;
}

}  // namespace

struct MultiView::Stages {
  Stages(const MultiViewSettings& s, const Rig& rig, std::span<const MultiViewCamera> cameras)
      : settings(s),
        volume(choose_volume(s, rig)),
        rays(trace(rig, volume)),
        correspondence(rays, volume,
                       {static_cast<std::size_t>(s.min_views), s.tolerance_px,
                        static_cast<std::size_t>(s.detector.max_detections), static_cast<std::size_t>(s.max_matches)}),
        ghosts(rays.size(), static_cast<std::size_t>(s.detector.max_detections),
               static_cast<std::size_t>(s.max_matches), {s.tolerance_px, s.ghosts == "rank"}) {
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      detectors.emplace_back(s.detector, cameras[c].shape, cameras[c].background, c);
      seen.emplace_back(static_cast<std::size_t>(s.detector.max_detections));
      shapes.push_back(cameras[c].shape);
    }
    chosen.reserve(static_cast<std::size_t>(s.max_matches));
    partial.reserve(static_cast<std::size_t>(s.max_matches));
    particles.reserve(static_cast<std::size_t>(s.max_matches));
  }

  bool usable(const Frame& frame, std::size_t camera) const noexcept {
    return frame.view().data != nullptr && !frame.info.torn && frame.shape.has_size_of(shapes[camera]);
  }
  void choose(std::span<const ViewMatch> matches) noexcept;
  void write(std::span<const ViewMatch> matches, std::span<const Detections> lists, Particles& out) noexcept;
  void tell(Losses& losses) const noexcept;

  const MultiViewSettings settings;
  const Volume volume;
  const std::vector<ViewRays> rays;
  std::vector<ImageShape> shapes;
  std::vector<Detector> detectors;
  std::vector<Detections> seen;
  Correspondence correspondence;
  ViewGhosts ghosts;
  std::vector<std::uint32_t> chosen;
  std::vector<ViewTuple> partial;
  std::vector<Particle> particles;
  MultiViewCounts counts;
};

// What a set loses to others may leave enough views to be a particle: such remains compete again.
void MultiView::Stages::choose(std::span<const ViewMatch> matches) noexcept {
  constexpr int kRounds = 4;
  chosen.clear();
  ghosts.clear();
  std::size_t first = 0;
  for (int round = 0; round < kRounds && !matches.empty(); ++round) {
    for (const std::uint32_t m : ghosts.choose(matches)) chosen.push_back(m + static_cast<std::uint32_t>(first));
    partial.clear();
    for (const ViewMatch& match : matches) {
      ViewTuple rest = match.tuple;
      for (std::size_t v = 0; v < rays.size(); ++v)
        if (rest.detection[v] != kUnseen && ghosts.used(v, rest.detection[v])) rest.put(v, kUnseen);
      if (rest.views >= correspondence.options().min_views && rest.views < match.tuple.views) partial.push_back(rest);
    }
    first += matches.size();
    matches = correspondence.add(partial);
  }
}

void MultiView::Stages::write(std::span<const ViewMatch> matches, std::span<const Detections> lists,
                              Particles& out) noexcept {
  const ChanceOfMatch chance(correspondence, settings.tolerance_px);
  particles.clear();
  for (const std::uint32_t m : chosen) {
    particles.push_back(fit_views(correspondence.views(), lists, matches[m], settings.calibration_px));
    particles.back().ghost = chance.of(matches[m]);
  }
  std::sort(particles.begin(), particles.end(), [](const Particle& a, const Particle& b) {
    return a.support != b.support ? a.support > b.support : a.residual_mm < b.residual_mm;
  });
  const Point3 centre = volume.centre();
  for (Particle& particle : particles) {
    particle.x_mm += centre[0], particle.y_mm += centre[1], particle.z_mm += centre[2];
    out.push(particle);
  }
  counts.refused_particles += out.overflow();
}

void MultiView::Stages::tell(Losses& losses) const noexcept {
  const CorrespondenceCounts& matching = correspondence.counts();
  losses.set(LossCause::frame_refused, counts.refused_frames);
  losses.set(LossCause::view_refused, counts.refused_views);
  losses.set(LossCause::too_few_views, counts.too_few_views);
  losses.set(LossCause::detection_overflow, counts.refused_detections);
  losses.set(LossCause::match_overflow, matching.refused_matches + matching.refused_hits);
  losses.set(LossCause::search_cut, matching.unsearched);
}

MultiView::MultiView(const MultiViewSettings& settings, const Rig& rig, std::span<const MultiViewCamera> cameras)
    : stages_(std::make_unique<Stages>(settings, choose_cameras(settings, rig, cameras), cameras)) {}

MultiView::~MultiView() = default;
std::span<const Detections> MultiView::detections() const noexcept { return stages_->seen; }
const MultiViewCounts& MultiView::counts() const noexcept { return stages_->counts; }
const Volume& MultiView::volume() const noexcept { return stages_->volume; }
const CorrespondenceCounts& MultiView::correspondence_counts() const noexcept {
  return stages_->correspondence.counts();
}

void MultiView::reconstruct(const FrameSet& frames, Particles& out) noexcept {
  auto& s = *stages_;
  out.clear();
  if (frames.cameras != s.detectors.size()) {
    ++s.counts.refused_frames;
    return s.tell(losses_);
  }
  std::size_t views = 0;
  for (std::size_t c = 0; c < frames.cameras; ++c) views += s.usable(frames.frames[c], c) ? 1 : 0;
  s.counts.refused_views += frames.cameras - views;
  const std::size_t threads = std::min(thread_count(s.settings.threads), s.detectors.size());
  parallel_for(s.detectors.size(), threads, [&](std::size_t camera, std::size_t) {
    s.seen[camera].clear();
    if (s.usable(frames.frames[camera], camera))
      s.detectors[camera].detect(frames.frames[camera].view(), s.seen[camera]);
  });
  for (const Detections& seen : s.seen) s.counts.refused_detections += seen.overflow();
  if (views < static_cast<std::size_t>(s.settings.min_views)) {
    ++s.counts.too_few_views;
    return s.tell(losses_);
  }
  reconstruct(s.seen, out);
}

void MultiView::reconstruct(std::span<const Detections> seen, Particles& out) noexcept {
  auto& s = *stages_;
  out.clear();
  const auto matches = s.correspondence.match(seen);
  s.choose(matches);
  s.write({matches.data(), s.correspondence.size()}, seen, out);
  ++s.counts.frames;
  s.tell(losses_);
}

}  // namespace rptv
