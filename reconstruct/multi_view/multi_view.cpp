// SPDX-License-Identifier: MIT
// The multi-view chain, one step a line.
#include "reconstruct/multi_view/multi_view.hpp"

#include <algorithm>

#include "reconstruct/detection/detector.hpp"
#include "reconstruct/multi_view/chance_of_match.hpp"
#include "reconstruct/multi_view/view_fit.hpp"
#include "reconstruct/multi_view/view_ghosts.hpp"
#include "reconstruct/multi_view/view_losses.hpp"
#include "reconstruct/parallel.hpp"

namespace rptv {

struct MultiView::Stages {
  Stages(const MultiViewSettings& s, const Rig& rig, std::span<const MultiViewCamera> cameras)
      : settings(s),  // max_matches > 0
        gate(cameras, static_cast<std::size_t>(s.min_views)),
        volume(choose_volume(s, rig)),
        rays(trace_views(rig, volume)),
        correspondence(rays, volume, matching_of(s)),
        ghosts(rays.size(), static_cast<std::size_t>(s.detector.max_detections),
               static_cast<std::size_t>(s.max_matches), {s.tolerance_px, s.ghosts == "rank"}) {
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      detectors.emplace_back(s.detector, cameras[c].shape, cameras[c].background, c);
      seen.emplace_back(static_cast<std::size_t>(s.detector.max_detections));
    }
    chosen.reserve(static_cast<std::size_t>(s.max_matches));
    partial.reserve(static_cast<std::size_t>(s.max_matches));
    particles.reserve(static_cast<std::size_t>(s.max_matches));
  }

  void choose(std::span<const ViewMatch> matches) noexcept;
  void write(std::span<const ViewMatch> matches, std::span<const Detections> lists, Particles& out) noexcept;
  void tell(Losses& losses) const noexcept;

  const MultiViewSettings settings;
  const FrameGate gate;
  const Volume volume;
  const std::vector<ViewRays> rays;
  std::vector<Detector> detectors;
  std::vector<Detections> seen;
  Correspondence correspondence;
  ViewGhosts ghosts;
  std::vector<std::uint32_t> chosen;
  std::vector<ViewTuple> partial;
  std::vector<Particle> particles;
  MultiViewCounts counts;
  ViewObserver* observer = nullptr;
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
  tell_view_losses(counts, correspondence.counts(), counts.refused_detections, losses);
}

MultiView::MultiView(const MultiViewSettings& settings, const Rig& rig, std::span<const MultiViewCamera> cameras) {
  const Rig chosen = choose_cameras(settings, rig, cameras);
  stages_ = std::make_unique<Stages>(with_room(settings, chosen), chosen, cameras);
}

MultiView::~MultiView() = default;
std::span<const Detections> MultiView::detections() const noexcept { return stages_->seen; }
const MultiViewCounts& MultiView::counts() const noexcept { return stages_->counts; }
const std::vector<ViewRays>& MultiView::rays() const noexcept { return stages_->rays; }
void MultiView::show_to(ViewObserver* observer) noexcept { stages_->observer = observer; }
const Volume& MultiView::volume() const noexcept { return stages_->volume; }
const CorrespondenceCounts& MultiView::correspondence_counts() const noexcept {
  return stages_->correspondence.counts();
}

void MultiView::reconstruct(const FrameSet& frames, Particles& out) noexcept {
  auto& s = *stages_;
  out.clear();
  for (Detections& seen : s.seen) seen.clear();
  if (s.gate.admit(frames, s.counts) == 0) return s.tell(losses_);
  const std::size_t threads = std::min(thread_count(s.settings.threads), s.detectors.size());
  parallel_for(s.detectors.size(), threads, [&](std::size_t camera, std::size_t) {
    if (s.gate.usable(frames.frames[camera], camera))
      s.detectors[camera].detect(frames.frames[camera].view(), s.seen[camera]);
  });
  for (const Detections& seen : s.seen) s.counts.refused_detections += seen.overflow();
  reconstruct(s.seen, out);
}

void MultiView::reconstruct(std::span<const Detections> seen, Particles& out) noexcept {
  auto& s = *stages_;
  out.clear();
  const auto matches = s.correspondence.match(seen);
  s.choose(matches);
  s.write({matches.data(), s.correspondence.size()}, seen, out);
  ++s.counts.frames;
  if (s.observer != nullptr) s.observer->see(seen);
  s.tell(losses_);
}

}  // namespace rptv
