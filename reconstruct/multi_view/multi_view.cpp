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
  Stages(const MultiViewSettings& s, const Rig& rig, std::span<const MultiViewCamera> cameras)
      : settings(s),
        gate(cameras, static_cast<std::size_t>(s.min_views)),
        volume(choose_volume(s, rig)),
        rays(trace_views(rig, volume)),
        threads(std::min(thread_count(s.threads), cameras.size())),
        correspondence(rays, volume, matching_of(s, threads)),
        ghosts(rays.size(), static_cast<std::size_t>(s.detector.max_detections),
               static_cast<std::size_t>(s.max_matches), {s.tolerance_px, s.ghosts == "rank"}) {
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      detectors.emplace_back(s.detector, cameras[c].shape, cameras[c].background, c);
      seen.emplace_back(static_cast<std::size_t>(s.detector.max_detections));
    }
    chosen.reserve(static_cast<std::size_t>(s.max_matches));
    partial.reserve(static_cast<std::size_t>(s.max_matches));
    particles.reserve(static_cast<std::size_t>(s.max_matches));
    order.reserve(static_cast<std::size_t>(s.max_matches));
  }

  void particles_of(std::span<const Detections> lists, Particles& out) noexcept;
  void choose(std::span<const ViewMatch> matches) noexcept;
  void write(std::span<const ViewMatch> matches, std::span<const Detections> lists, Particles& out) noexcept;
  void tell(Losses& losses) const noexcept;
  void take(const MakeDetectDevice& make_device, std::span<const MultiViewCamera> cameras);
  bool detect_on_device(const FrameSet& frames) noexcept;

  const MultiViewSettings settings;
  const FrameGate gate;
  const Volume volume;
  const std::vector<ViewRays> rays;
  const std::size_t threads;  // of every parallel loop: OpenMP would end and begin threads where the number changes
  std::vector<Detector> detectors;
  std::unique_ptr<DetectDevice> device;  // until it fails
  std::vector<ImageView> images;         // for it
  std::vector<Detections> seen;
  Correspondence correspondence;
  ViewGhosts ghosts;
  std::vector<std::uint32_t> chosen;
  std::vector<ViewTuple> partial;
  std::vector<Particle> particles;
  std::vector<std::uint32_t> order;
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
  constexpr std::size_t kPart = 64;
  const ChanceOfMatch chance(correspondence, settings.tolerance_px);
  particles.resize(chosen.size()), order.resize(chosen.size());
  parallel_for((chosen.size() + kPart - 1) / kPart, threads, [&](std::size_t part, std::size_t) {
    for (std::size_t i = part * kPart; i < std::min((part + 1) * kPart, chosen.size()); ++i) {
      particles[i] = fit_views(correspondence.views(), lists, matches[chosen[i]], settings.calibration_px);
      particles[i].ghost = chance.of(matches[chosen[i]]);
    }
  });
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [this](std::uint32_t i, std::uint32_t k) {
    const Particle &a = particles[i], &b = particles[k];
    return std::tuple(-a.support, a.residual_mm, i) < std::tuple(-b.support, b.residual_mm, k);
  });
  const Point3 centre = volume.centre();
  for (const std::uint32_t i : order) {
    Particle& particle = particles[i];
    particle.x_mm += centre[0], particle.y_mm += centre[1], particle.z_mm += centre[2];
    out.push(particle);
  }
  counts.refused_particles += out.overflow();
}

void MultiView::Stages::tell(Losses& losses) const noexcept {
  tell_view_losses(counts, correspondence.counts(), counts.refused_detections, losses);
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
  device.reset(), counts.device_failed = true;
  for (Detections& list : seen) list.clear();
  return false;
}

MultiView::MultiView(const MultiViewSettings& settings, const Rig& rig, std::span<const MultiViewCamera> cameras,
                     const MakeDetectDevice& make_device)
    : stages_(std::make_unique<Stages>(settings, choose_cameras(settings, rig, cameras), cameras)) {
  if (make_device) stages_->take(make_device, cameras);
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
  const bool by_device = s.detect_on_device(frames);
  parallel_for(s.detectors.size(), s.threads, [&](std::size_t camera, std::size_t) {
    if (!by_device && s.gate.usable(frames.frames[camera], camera))
      s.detectors[camera].detect(frames.frames[camera].view(), s.seen[camera]);
    s.correspondence.look(camera, s.seen[camera]);
  });
  if (s.counts.device_failed) count_set_without_device();
  for (const Detections& seen : s.seen) s.counts.refused_detections += seen.overflow();
  s.particles_of(s.seen, out);
  s.tell(losses_);
}

void MultiView::reconstruct(std::span<const Detections> seen, Particles& out) noexcept {
  auto& s = *stages_;
  out.clear();
  parallel_for(seen.size(), s.threads,
               [&](std::size_t camera, std::size_t) { s.correspondence.look(camera, seen[camera]); });
  s.particles_of(seen, out);
  s.tell(losses_);
}

/// Of lists that correspondence has looked at.
void MultiView::Stages::particles_of(std::span<const Detections> lists, Particles& out) noexcept {
  const auto matches = correspondence.match();
  choose(matches);
  write({matches.data(), correspondence.size()}, lists, out);
  ++counts.frames;
  if (observer != nullptr) observer->see(lists);
}

}  // namespace rptv
