// SPDX-License-Identifier: MIT
// Rounds of: peaks of the residuals, matching, shaking.
#include "reconstruct/multi_view/iterative_views.hpp"

#include <algorithm>
#include <cmath>

#include "calibration/space_algebra.hpp"
#include "core/error.hpp"
#include "reconstruct/multi_view/residual_peaks.hpp"
#include "reconstruct/multi_view/shaken_particles.hpp"
#include "reconstruct/multi_view/view_ghosts.hpp"
#include "reconstruct/multi_view/view_losses.hpp"
#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {

constexpr std::uint32_t kTellingAge_frames = 1;  // with fewer frames before, a track has no velocity
// Chance sets take light from those that are not found yet, but hardly that much; faint particles come in later rounds.
constexpr double kEarlyShare = 0.5;

/// How the rounds of one kind search, and when they end.
struct Rounds {
  std::int64_t most;
  std::size_t min_views;
  double tolerance_px, least_share;
  double worthwhile;  ///< part of all particles that a round adds at least, or is the last
};

}  // namespace

struct IterativeViews::Stages {
  Stages(const MultiViewSettings& s, const Rig& rig, std::span<const MultiViewCamera> cameras)
      : settings(s),
        gate(cameras, static_cast<std::size_t>(s.min_views)),
        threads(thread_count(s.threads)),
        volume(choose_volume(s, rig)),
        rays(trace_views(rig, volume)),
        correspondence(rays, volume, matching_of(s, threads)),
        ghosts(rays.size(), static_cast<std::size_t>(s.detector.max_detections),
               static_cast<std::size_t>(s.max_matches), {s.iterative.tolerance_px, s.ghosts == "rank"}),
        peak_options{static_cast<float>(s.detector.threshold), static_cast<float>(s.detector.threshold_sigmas)},
        cloud(
            models_of(rig), views_of(s, cameras), volume,
            {static_cast<std::size_t>(s.max_particles), threads, s.iterative.sigma_px > 0 ? s.iterative.sigma_px : 1}),
        sigma_known(s.iterative.sigma_px > 0) {
    expected.reserve(static_cast<std::size_t>(s.max_particles));
    if (s.detector.running_background)
      throw Error(ExitCode::configuration,
                  "multi_view.detector.running_background = true, but multi_view.method = 'iterative' has none; give "
                  "multi_view.detector.background or background_images");
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      const auto& names = s.detector.background_images;
      dark.push_back(make_dark({s.detector.background, s.detector.threshold,
                                c < names.size() ? names[c] : std::string("the background image")},
                               cameras[c].shape, cameras[c].background));
      peaks.emplace_back(static_cast<std::size_t>(s.detector.max_detections));
      scratch.emplace_back(static_cast<std::size_t>(s.detector.max_detections));
    }
  }
  static std::vector<CameraModel> models_of(const Rig& rig) {
    std::vector<CameraModel> models;
    for (const RigCamera& camera : rig.cameras) models.push_back(camera.model);
    return models;
  }
  static std::vector<ResidualView> views_of(const MultiViewSettings& s, std::span<const MultiViewCamera> cameras) {
    std::vector<ResidualView> views;
    for (const MultiViewCamera& camera : cameras)
      views.emplace_back(camera.shape, GreyNoise::of(s.detector.noise_grey, s.detector.electrons_per_grey),
                         s.detector.saturation_grey);
    return views;
  }

  void load(const FrameSet& frames) noexcept;
  void find_all_peaks() noexcept;
  std::size_t search(std::size_t min_views, double tolerance_px) noexcept;
  void go_round(const Rounds& rounds) noexcept;
  void start() noexcept;
  void take(const ViewMatch& match) noexcept;
  void shake(std::int64_t sweeps, double least_share) noexcept;
  void write(Particles& out) noexcept;
  void tell(Losses& losses) const noexcept {
    tell_view_losses(counts, correspondence.counts(), counts.refused_peaks, losses);
    losses.set(LossCause::candidate_overflow, counts.refused_places);
  }

  const MultiViewSettings settings;
  const FrameGate gate;
  const std::size_t threads;
  const Volume volume;
  const std::vector<ViewRays> rays;
  Correspondence correspondence;
  ViewGhosts ghosts;
  const PeakOptions peak_options;
  ShakenParticles cloud;
  bool sigma_known;
  std::vector<DarkPixels> dark;
  std::vector<Detections> peaks;
  std::vector<std::vector<float>> scratch;
  std::vector<Point3> expected;
  IterativeCounts counts;
  ViewObserver* observer = nullptr;
};

void IterativeViews::Stages::load(const FrameSet& frames) noexcept {
  parallel_for(gate.cameras(), threads, [&](std::size_t c, std::size_t) {
    ResidualView& view = cloud.views()[c];
    if (!gate.usable(frames.frames[c], c)) return view.load_nothing();
    view.load(frames.frames[c].view(), dark[c]);
    if (!sigma_known) cloud.set_sigma(c, typical_sigma_px(view, peak_options, scratch[c], 1));
  });
}

void IterativeViews::Stages::find_all_peaks() noexcept {
  parallel_for(rays.size(), threads, [&](std::size_t v, std::size_t) {
    find_peaks(cloud.views()[v], peak_options, static_cast<float>(cloud.sigma_px(v)), peaks[v]);
  });
}

// Of the tracks' particles one may be gone, and the light of its neighbours be taken for it: twice, so that those that
// are let go do not disturb the others.
void IterativeViews::Stages::start() noexcept {
  const float grey = cloud.median_grey();
  cloud.clear();
  for (const Point3& at_mm : expected) counts.refused_places += cloud.push(at_mm, grey) ? 0 : 1;
  expected.clear();
  if (cloud.all().empty()) return;
  counts.expected += cloud.all().size();
  for (int i = 0; i < 2; ++i) shake(settings.iterative.sweeps, settings.iterative.least_share);
}

void IterativeViews::Stages::take(const ViewMatch& match) noexcept {
  double grey = HUGE_VAL;
  for (std::size_t v = 0; v < rays.size(); ++v)
    if (match.tuple.detection[v] != kUnseen)
      grey = std::min(grey, peaks[v].grey[match.tuple.detection[v]] / cloud.gain(v));
  if (cloud.push(volume.centre() + match.at_mm, static_cast<float>(grey)))
    ++counts.found;
  else
    ++counts.refused_places;
}

// Returns how many it took up.
std::size_t IterativeViews::Stages::search(std::size_t min_views, double tolerance_px) noexcept {
  find_all_peaks();
  for (const Detections& list : peaks) counts.refused_peaks += list.overflow();
  correspondence.demand(min_views, tolerance_px);
  const auto matches = correspondence.match(peaks);
  ghosts.clear();
  const std::size_t before = cloud.all().size();
  for (const std::uint32_t m : ghosts.choose(matches)) take(matches[m]);
  return cloud.all().size() - before;
}

void IterativeViews::Stages::go_round(const Rounds& rounds) noexcept {
  for (std::int64_t round = 0; round < rounds.most; ++round) {
    const auto before = static_cast<double>(cloud.all().size());
    if (search(rounds.min_views, rounds.tolerance_px) == 0) return;
    shake(settings.iterative.sweeps, rounds.least_share);
    const auto after = static_cast<double>(cloud.all().size());
    if (after - before < rounds.worthwhile * after) return;
  }
}

void IterativeViews::Stages::shake(std::int64_t sweeps, double least_share) noexcept {
  cloud.subtract();
  for (std::int64_t i = 0; i < sweeps; ++i) cloud.sweep();
  const std::size_t went = cloud.drop(least_share, settings.iterative.apart_px);
  counts.dropped += went;
  cloud.subtract();
  cloud.fit_images();
}

void IterativeViews::Stages::write(Particles& out) noexcept {
  for (const ShakenParticle& shaken : cloud.all()) {
    Particle particle;
    particle.x_mm = shaken.at_mm[0], particle.y_mm = shaken.at_mm[1], particle.z_mm = shaken.at_mm[2];
    particle.residual_mm = shaken.miss_px / cloud.px_per_mm();
    particle.support = shaken.views;
    particle.covariance_mm2 = shaken.covariance_mm2;
    out.push(particle);
  }
  counts.refused_particles += out.overflow();
}

IterativeViews::IterativeViews(const MultiViewSettings& settings, const Rig& rig,
                               std::span<const MultiViewCamera> cameras)
    : stages_(std::make_unique<Stages>(settings, choose_cameras(settings, rig, cameras), cameras)) {}

IterativeViews::~IterativeViews() = default;
const IterativeCounts& IterativeViews::counts() const noexcept { return stages_->counts; }
const CorrespondenceCounts& IterativeViews::correspondence_counts() const noexcept {
  return stages_->correspondence.counts();
}

void IterativeViews::show_to(ViewObserver* observer) noexcept { stages_->observer = observer; }
const Volume& IterativeViews::volume() const noexcept { return stages_->volume; }
const std::vector<ViewRays>& IterativeViews::rays() const noexcept { return stages_->rays; }

bool IterativeViews::uses_tracks() const noexcept { return stages_->settings.iterative.use_tracks; }

void IterativeViews::expect(const Tracks& expected) noexcept {
  auto& s = *stages_;
  s.expected.clear();
  for (std::size_t i = 0; i < expected.size() && s.expected.size() < s.expected.capacity(); ++i)
    if (expected.age_frames[i] >= kTellingAge_frames)
      s.expected.push_back({expected.x_mm[i], expected.y_mm[i], expected.z_mm[i]});
}

void IterativeViews::reconstruct(const FrameSet& frames, Particles& out) noexcept {
  auto& s = *stages_;
  out.clear();
  const std::size_t views = s.gate.admit(frames, s.counts);
  if (views == 0) return s.tell(losses_);
  s.load(frames);
  if (s.observer != nullptr && s.observer->wants()) {
    s.find_all_peaks();
    s.observer->see(s.peaks);
  }
  s.start();
  const IterationSettings& iterative = s.settings.iterative;
  const std::size_t reduced = std::max(static_cast<std::size_t>(s.settings.min_views), views - 1);
  const double early_share = std::max(iterative.least_share, kEarlyShare);
  s.go_round({iterative.rounds, views, iterative.tolerance_px, early_share, 0.005});
  s.go_round({iterative.reduced_rounds, reduced, iterative.reduced_tolerance_px, iterative.least_share, 0.001});
  s.shake(iterative.final_sweeps, iterative.least_share);
  s.sigma_known = s.sigma_known || s.cloud.all().size() >= ShakenParticles::kTellingParticles;
  s.write(out);
  ++s.counts.frames;
  s.tell(losses_);
}

}  // namespace rptv
