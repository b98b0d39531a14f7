// SPDX-License-Identifier: MIT
// The hand-over of samples, the monitor's thread, and what its figures mean.
#include "daemon/drift_monitor.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>

#include "core/clock.hpp"
#include "daemon/blind_views.hpp"
#include "reconstruct/multi_view/view_setup.hpp"

namespace rptv {
namespace {

constexpr std::size_t kLeastCameras = 3;         // two disagree across their epipolar lines only
constexpr std::size_t kSearchedViews = 4;        // more lose the particles that one camera misses
constexpr std::size_t kMostMatches = 16384;      // of a frame: bounds the time of a look
constexpr std::uint32_t kLeastParts = 2;         // of eight that an alarm needs
constexpr double kLeastVotes = 50;               // of all parts together
constexpr std::size_t kUsualDetections = 16384;  // of a view: there is room from the start
constexpr int kNicest = 19;
constexpr std::int64_t kPatienceNs = 200'000'000;

DisparityReport report_of(const std::string& camera, const CameraDisparity& found) {
  if (found.parts == 0) return {camera, 0, 0, 0, 0, {}};
  return {camera,           static_cast<std::uint32_t>(found.parts), found.votes, found.median_px, found.worst_px,
          found.worst_at_mm};
}

}  // namespace

DriftMonitor::DriftMonitor(Rig rig, std::vector<ViewRays> rays, const Volume& volume, const DriftOptions& options)
    : rig_(std::move(rig)),
      rays_(std::move(rays)),
      options_(options),
      search_{volume, std::min(rig_.cameras.size(), kSearchedViews), kMostMatches},
      maps_({volume.from, volume.to, {2, 2, 2}}, rig_.cameras.size(), kSearched_px),
      sample_(rig_.cameras.size()) {
  for (auto& view : sample_) view.resize(std::min(options.most_detections, kUsualDetections));
  frames_.assign(kFramesALook, sample_);
  for (auto& view : sample_) view.resize(options.most_detections), view.clear();
  thread_ = std::thread([this] { run(); });
  pthread_setname_np(thread_.native_handle(), "rptv-drift");
}

DriftMonitor::~DriftMonitor() {
  ending_.store(true, std::memory_order_release);
  wake_.notify();
  thread_.join();
}

bool DriftMonitor::wants() noexcept {
  // acquire, pairs with run(): the monitor has done with the sample that see() is about to write over.
  const bool wanted = wanted_.load(std::memory_order_acquire);
  if (!wanted) passed_over_.fetch_add(1, std::memory_order_relaxed);
  return wanted;
}

void DriftMonitor::see(std::span<const Detections> views) noexcept {
  const std::uint32_t blind = blind_views(views);
  for (std::size_t c = 0; c < views.size(); ++c)
    if ((blind >> c & 1U) != 0) dark_[c].fetch_add(1, std::memory_order_relaxed);
  shown_.fetch_add(1, std::memory_order_relaxed);
  if (!wants()) return;
  if (std::any_of(views.begin(), views.end(),
                  [this](const Detections& seen) { return seen.size() > options_.most_detections; })) {
    passed_over_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  for (std::size_t c = 0; c < sample_.size(); ++c) {
    const Detections& seen = views[c];
    sample_[c].clear();
    for (std::size_t i = 0; i < seen.size(); ++i) sample_[c].push_back({{seen.x_px[i], seen.y_px[i]}, seen.grey[i]});
  }
  wanted_.store(false, std::memory_order_release);
  wake_.notify();
}

void DriftMonitor::run() noexcept {
  const sched_param none{};
  pthread_setschedparam(pthread_self(), SCHED_BATCH, &none);  // where the process has a real-time policy, too
  setpriority(PRIO_PROCESS, 0, kNicest);                      // on Linux of the calling thread
  const auto rest_ns = static_cast<std::int64_t>(options_.window_s * 1e9 / (kFramesALook * kLooksAWindow));
  bool resting = false;
  std::int64_t wanted_from_ns = 0;
  while (!ending_.load(std::memory_order_acquire)) {
    const std::uint32_t seen = wake_.prepare();  // before the looks: what comes after them ends the wait
    const std::int64_t now_ns = host_now_ns();
    if (resting && now_ns >= wanted_from_ns) {
      resting = false;
      wanted_.store(true, std::memory_order_release);
    } else if (!resting && !wanted_.load(std::memory_order_acquire)) {
      resting = true, wanted_from_ns = now_ns + rest_ns;
      take();
    } else if (!ending_.load(std::memory_order_acquire)) {
      wake_.wait(seen, resting ? wanted_from_ns - now_ns : kPatienceNs);
    }
  }
}

void DriftMonitor::take() noexcept try {
  for (std::size_t c = 0; c < sample_.size(); ++c) frames_[taken_][c].assign(sample_[c].begin(), sample_[c].end());
  if (++taken_ < kFramesALook) return;
  taken_ = 0;
  look();
} catch (const std::exception& error) {
  spdlog::warn("the drift of the cameras was not looked at: {}", error.what());
}

void DriftMonitor::look() {
  maps_.fade(std::exp(-1.0 / kLooksAWindow));
  gather_disparities(rig_, rays_, search_, frames_, maps_);
  DriftReport& found = found_.back();
  found.looked_at = looked_at_ += frames_.size();
  found.cameras.clear();
  for (std::size_t c = 0; c < rig_.cameras.size(); ++c)
    found.cameras.push_back(report_of(rig_.cameras[c].name, maps_.summary(c)));
  found_.publish();
}

std::string DriftMonitor::warning(const DriftReport& drift) const {
  const DisparityReport* worst = nullptr;
  for (const DisparityReport& camera : drift.cameras)
    if (camera.parts >= kLeastParts && camera.votes >= kLeastVotes &&
        camera.median_px > (worst != nullptr ? worst->median_px : options_.alarm_px))
      worst = &camera;
  if (worst == nullptr) return {};
  return fmt::format(
      "camera '{}' sees particles {:.1f} px from where {} says: it {}has drifted; record some seconds and run "
      "`rapidptv calibrate refine FRAMES --start {} -o better.toml`",
      worst->camera, worst->median_px, options_.rig_file,
      drift.cameras.size() > kLeastCameras ? "" : "or another of the three ", options_.rig_file);
}

void DriftMonitor::tell_blind(StatusReport& status) {
  const std::uint64_t shown = shown_.exchange(0, std::memory_order_relaxed);
  for (std::size_t c = 0; c < rig_.cameras.size(); ++c) {
    const std::uint32_t bit = 1U << c;
    const std::uint64_t dark = dark_[c].exchange(0, std::memory_order_relaxed);
    const bool was = (blind_ & bit) != 0, is = shown > 0 ? 2 * dark > shown : was;
    blind_ = is ? blind_ | bit : blind_ & ~bit;
    if (!is) continue;
    status.warnings.push_back(blind_warning(rig_.cameras[c].name));
    if (!was) spdlog::warn("{}", status.warnings.back());
  }
}

void DriftMonitor::tell(StatusReport& status) {
  tell_blind(status);
  found_.refresh();
  status.drift = found_.front();
  status.drift.watched = true;
  status.drift.passed_over = passed_over_.load(std::memory_order_relaxed);
  const std::string line = warning(status.drift);
  if (!line.empty() && !warned_) spdlog::warn("{}", line);
  warned_ = !line.empty();
  if (warned_) status.warnings.push_back(line);
}

std::unique_ptr<DriftMonitor> make_drift_monitor(const Config& config, const std::vector<CameraInfo>& cameras,
                                                 Reconstructor& reconstructor) {
  const MultiViewSettings& settings = config.multi_view;
  auto* views = dynamic_cast<ObservableViews*>(&reconstructor);
  if (views == nullptr || settings.drift_alarm_px == 0 || cameras.size() < kLeastCameras) return nullptr;
  std::vector<MultiViewCamera> seen;
  for (const CameraInfo& camera : cameras) seen.push_back({camera.name, camera.shape, {}});
  const DriftOptions options{settings.drift_window_s, settings.drift_alarm_px,
                             static_cast<std::size_t>(settings.detector.max_detections), settings.rig};
  auto monitor = std::make_unique<DriftMonitor>(choose_cameras(settings, read_rig(settings.rig), seen), views->rays(),
                                                views->volume(), options);
  views->show_to(monitor.get());
  return monitor;
}

}  // namespace rptv
