// SPDX-License-Identifier: MIT
// The multi-view chain, one step a line.
#include "reconstruct/multi_view/multi_view.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "reconstruct/detection/detector.hpp"
#include "reconstruct/multi_view/chance_of_match.hpp"
#include "reconstruct/multi_view/view_fit.hpp"
#include "reconstruct/multi_view/view_ghosts.hpp"
#include "reconstruct/multi_view/view_losses.hpp"
#include "reconstruct/parallel.hpp"

namespace rptv {

struct MultiView::Stages {
  /// Best first: many views, then small residuals.
  struct Rank {
    double support, residual_mm;
    std::uint32_t particle;
    bool operator<(const Rank& other) const noexcept {
      return std::tuple(-support, residual_mm, particle) <
             std::tuple(-other.support, other.residual_mm, other.particle);
    }
  };

  Stages(const MultiViewSettings& s, const Rig& rig, std::span<const MultiViewCamera> cameras)
      : settings(s),  // max_matches > 0
        gate(cameras, static_cast<std::size_t>(s.min_views)),
        volume(choose_volume(s, rig)),
        rays(trace_views(rig, volume)),
        threads(std::min(thread_count(s.threads), cameras.size())),
        correspondence(rays, volume, matching_of(s, threads)),
        ghosts(rays.size(), static_cast<std::size_t>(s.detector.max_detections),
               static_cast<std::size_t>(s.max_matches), ghosts_of(s, s.tolerance_px)) {
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      detectors.emplace_back(s.detector, cameras[c].shape, cameras[c].background, c);
      seen.emplace_back(static_cast<std::size_t>(s.detector.max_detections));
    }
    chosen.reserve(static_cast<std::size_t>(s.max_matches));
    partial.reserve(static_cast<std::size_t>(s.max_matches));
    particles.reserve(static_cast<std::size_t>(s.max_matches));
    order.reserve(static_cast<std::size_t>(s.max_matches));
  }

  void look(std::span<const Detections> lists) noexcept;
  void particles_of(std::span<const Detections> lists, Particles& out) noexcept;
  /// Lists and chooses matches; gives the views that their numbers are of.
  std::span<const SeenView> match(std::span<const Detections> lists) noexcept;
  void choose(std::span<const ViewMatch> listed) noexcept;
  void write(std::span<const SeenView> views, std::span<const Detections> lists, Particles& out) noexcept;
  void tell(Losses& losses) const noexcept;
  void take(const MakeDetectDevice& make_device, std::span<const MultiViewCamera> cameras);
  bool detect_on_device(const FrameSet& frames) noexcept;
  bool match_on_device(std::span<const Detections> lists) noexcept;
  void leave_device() noexcept;

  const MultiViewSettings settings;
  const FrameGate gate;
  const Volume volume;
  const std::vector<ViewRays> rays;
  const std::size_t threads;  // of every parallel loop: OpenMP would end and begin threads where the number changes
  std::vector<Detector> detectors;
  std::unique_ptr<DetectDevice> device;  // until one of them fails
  std::unique_ptr<MatchDevice> matcher;
  std::vector<ImageView> images;  // for the device
  std::vector<Detections> seen;
  Correspondence correspondence;
  ViewGhosts ghosts;
  std::span<const ViewMatch> matches;
  std::vector<std::uint32_t> chosen;  // of them
  CorrespondenceCounts matching, by_device;
  std::vector<ViewTuple> partial;
  std::vector<Particle> particles;
  std::vector<Rank> order;
  MultiViewCounts counts;
  ViewObserver* observer = nullptr;
};

std::span<const SeenView> MultiView::Stages::match(std::span<const Detections> lists) noexcept {
  const bool looked = matcher == nullptr;
  if (match_on_device(lists)) return matcher->views();
  if (!looked) look(lists);
  choose(correspondence.match());
  matches = correspondence.all();
  matching = correspondence.counts();
  matching.unusable_detections += by_device.unusable_detections;
  matching.refused_hits += by_device.refused_hits, matching.refused_matches += by_device.refused_matches;
  return correspondence.views();
}

bool MultiView::Stages::match_on_device(std::span<const Detections> lists) noexcept {
  if (!matcher) return false;
  if (!matcher->match(lists, matches, by_device)) {
    leave_device();
    return false;
  }
  matching = by_device;
  chosen.resize(matches.size());
  std::iota(chosen.begin(), chosen.end(), 0U);
  return true;
}

// What a set loses to others may leave enough views to be a particle: such remains compete again.
void MultiView::Stages::choose(std::span<const ViewMatch> listed) noexcept {
  constexpr int kRounds = 4;
  chosen.clear();
  ghosts.clear();
  std::size_t first = 0;
  for (int round = 0; round < kRounds && !listed.empty(); ++round) {
    for (const std::uint32_t m : ghosts.choose(listed)) chosen.push_back(m + static_cast<std::uint32_t>(first));
    partial.clear();
    for (const ViewMatch& match : listed) {
      ViewTuple rest = match.tuple;
      for (std::size_t v = 0; v < rays.size(); ++v)
        if (rest.detection[v] != kUnseen && ghosts.used(v, rest.detection[v])) rest.put(v, kUnseen);
      if (rest.views >= correspondence.options().min_views && rest.views < match.tuple.views) partial.push_back(rest);
    }
    first += listed.size();
    listed = correspondence.add(partial);
  }
}

void MultiView::Stages::write(std::span<const SeenView> views, std::span<const Detections> lists,
                              Particles& out) noexcept {
  constexpr std::size_t kPart = 64;
  const ChanceOfMatch chance(views, matching, settings.tolerance_px);
  particles.resize(chosen.size()), order.resize(chosen.size());
  parallel_for((chosen.size() + kPart - 1) / kPart, threads, [&](std::size_t part, std::size_t) {
    for (std::size_t i = part * kPart; i < std::min((part + 1) * kPart, chosen.size()); ++i) {
      particles[i] = fit_views(views, lists, matches[chosen[i]], settings.calibration_px);
      particles[i].ghost = chance.of(matches[chosen[i]]);
      order[i] = {particles[i].support, particles[i].residual_mm, static_cast<std::uint32_t>(i)};
    }
  });
  std::sort(order.begin(), order.end());
  const Point3 centre = volume.centre();
  for (const Rank& rank : order) {
    Particle& particle = particles[rank.particle];
    particle.x_mm += centre[0], particle.y_mm += centre[1], particle.z_mm += centre[2];
    out.push(particle);
  }
  counts.refused_particles += out.overflow();
}

void MultiView::Stages::tell(Losses& losses) const noexcept {
  tell_view_losses(counts, matching, counts.refused_detections, losses);
}

void MultiView::Stages::take(const MakeDetectDevice& make_device, std::span<const MultiViewCamera> cameras) {
  std::vector<ImageShape> shapes;
  std::vector<DarkPixels> dark;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    shapes.push_back(cameras[c].shape);
    dark.push_back(make_dark(dark_settings(settings.detector, c), cameras[c].shape, cameras[c].background));
  }
  device = make_device({settings.detector, shapes, dark});
  images.resize(cameras.size());
}

bool MultiView::Stages::detect_on_device(const FrameSet& frames) noexcept {
  if (!device) return false;
  for (std::size_t c = 0; c < images.size(); ++c)
    images[c] = gate.usable(frames.frames[c], c) ? frames.frames[c].view() : ImageView{};
  if (device->detect(images, seen)) return true;
  leave_device();
  for (Detections& list : seen) list.clear();
  return false;
}

void MultiView::Stages::leave_device() noexcept {
  device.reset(), matcher.reset();
  counts.device_failed = true;
}

MultiView::MultiView(const MultiViewSettings& settings, const Rig& rig, std::span<const MultiViewCamera> cameras,
                     const MakeDetectDevice& make_detect, const MakeMatchDevice& make_match) {
  const Rig chosen = choose_cameras(settings, rig, cameras);
  stages_ = std::make_unique<Stages>(with_room(settings, chosen), chosen, cameras);
  if (make_detect) stages_->take(make_detect, cameras);
  if (make_match) stages_->matcher = make_match({stages_->settings, chosen, cameras, stages_->rays, stages_->volume});
}

MultiView::~MultiView() = default;
std::span<const Detections> MultiView::detections() const noexcept { return stages_->seen; }
const MultiViewCounts& MultiView::counts() const noexcept { return stages_->counts; }
const std::vector<ViewRays>& MultiView::rays() const noexcept { return stages_->rays; }
void MultiView::show_to(ViewObserver* observer) noexcept { stages_->observer = observer; }
const Volume& MultiView::volume() const noexcept { return stages_->volume; }
const CorrespondenceCounts& MultiView::correspondence_counts() const noexcept { return stages_->matching; }

void MultiView::reconstruct(const FrameSet& frames, Particles& out) noexcept {
  auto& s = *stages_;
  out.clear();
  for (Detections& seen : s.seen) seen.clear();
  if (s.gate.admit(frames, s.counts) == 0) return s.tell(losses_);
  const bool by_device = s.detect_on_device(frames);
  parallel_for(s.detectors.size(), s.threads, [&](std::size_t camera, std::size_t) {
    if (!by_device && s.gate.usable(frames.frames[camera], camera))
      s.detectors[camera].detect(frames.frames[camera].view(), s.seen[camera]);
    if (!s.matcher) s.correspondence.look(camera, s.seen[camera]);
  });
  for (const Detections& seen : s.seen) s.counts.refused_detections += seen.overflow();
  s.particles_of(s.seen, out);
  if (s.counts.device_failed) count_set_without_device();
  s.tell(losses_);
}

void MultiView::reconstruct(std::span<const Detections> seen, Particles& out) noexcept {
  auto& s = *stages_;
  out.clear();
  if (!s.matcher) s.look(seen);
  s.particles_of(seen, out);
  if (s.counts.device_failed) count_set_without_device();
  s.tell(losses_);
}

void MultiView::Stages::look(std::span<const Detections> lists) noexcept {
  parallel_for(lists.size(), threads,
               [&](std::size_t camera, std::size_t) { correspondence.look(camera, lists[camera]); });
}

/// Of lists that correspondence has looked at, unless there is a matcher.
void MultiView::Stages::particles_of(std::span<const Detections> lists, Particles& out) noexcept {
  const std::span<const SeenView> views = match(lists);
  write(views, lists, out);
  ++counts.frames;
  if (observer != nullptr) observer->see(lists);
}

}  // namespace rptv
