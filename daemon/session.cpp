// SPDX-License-Identifier: MIT
// Wiring of one run, its status and its summary.
#include "daemon/session.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "daemon/backend.hpp"

namespace rptv {
namespace {

double seconds(std::int64_t ns) noexcept { return static_cast<double>(ns) * 1e-9; }

double rate_hz(std::uint64_t now, std::uint64_t before, std::int64_t elapsed_ns) noexcept {
  return elapsed_ns > 0 ? static_cast<double>(now - before) / seconds(elapsed_ns) : 0.0;
}

HandOverPolicy writer_policy(const Config& config) {
  // A recording loses nothing, so the disk may hold it up; a live run must not wait for a disk.
  if (config.intake.policy == "lossless") return Lossless{8};
  return Bounded{8};
}

}  // namespace

Session::Session(const Config& config) : Session(config, make_source(config)) {}

Session::Session(const Config& config, std::unique_ptr<Source> source, std::unique_ptr<Reconstructor> reconstructor) {
  if (!reconstructor) reconstructor = make_reconstructor(config, source->cameras(), &backend_text_);
  for (const CameraInfo& camera : source->cameras()) camera_names_.push_back(camera.name);
  drift_ = make_drift_monitor(config, source->cameras(), *reconstructor);
  const auto limit_ns = static_cast<std::int64_t>(config.intake.silence_alarm_s * 1e9);
  sync_warning_ = sync_warning(config, *source);
  alarm_ = std::make_unique<SilenceAlarm>(camera_names_, std::max(limit_ns, 3 * source->nominal_period_ns()));
  PipelineOptions options;
  options.intake = make_intake_options(config, *source);
  options.max_particles = config.max_particles();
  options.results_in_flight = static_cast<std::size_t>(config.publisher.queue_depth) + 24;
  pipeline_ = std::make_unique<Pipeline>(std::move(source), std::move(reconstructor), config.linker, options);
  if (!pipeline_->frames_locked())
    spdlog::warn(
        "frames could not be page-locked; copies to the GPU are slower: raise `ulimit -l` or lower pool_frames");
  publisher_ = std::make_unique<Publisher>(config.publisher,
                                           PublisherContent{options.max_particles, pipeline_->linker().capacity(),
                                                            config.calibration_text(), to_toml(config)},
                                           reader_losses_, [this](StatusReport& status) { fill_status(status); });
  pipeline_->add_reader([this](ResultLease&& result) { publisher_->publish(std::move(result)); });
  if (!config.output.tracks.empty() || !config.output.points.empty()) {
    writer_ = std::make_unique<ResultWriter>(config.output.tracks, config.output.points, writer_policy(config),
                                             reader_losses_, TrackColumns{.estimate = config.linker.filters()});
    pipeline_->add_reader([this](ResultLease&& result) { writer_->write(std::move(result)); });
  }
  publisher_->start();
}

Session::~Session() {
  pipeline_->stop();
  publisher_->stop();
}

void Session::start() {
  started_ns_ = host_now_ns();
  last_summary_ns_ = started_ns_;
  pipeline_->start();
  flowing_.store(true);
}

void Session::stop() {
  flowing_.store(false);
  if (stopped_ns_ == 0) last_cameras_ = camera_reports();
  pipeline_->stop();
  publisher_->stop();
  if (stopped_ns_ == 0) stopped_ns_ = host_now_ns();
  if (writer_) writer_->finish();
}

void Session::fill_status(StatusReport& status) {
  const std::int64_t now_ns = host_now_ns();
  const PipelineCounts now = counts();
  status.state = finished() ? RunState::draining : RunState::running;
  if (!source_failure().empty()) {
    status.state = RunState::failed;
    status.warnings.push_back(source_failure());
  }
  status.frames_in = now.reconstructed;
  status.results_out = now.linked;
  if (last_status_ns_ != 0) {
    status.input_hz = rate_hz(now.arrived, last_status_.arrived, now_ns - last_status_ns_);
    status.output_hz = rate_hz(now.linked, last_status_.linked, now_ns - last_status_ns_);
  }
  last_status_ns_ = now_ns;
  last_status_ = now;
  append_all_losses(status.losses);
  status.cameras = camera_reports();
  if (drift_) drift_->tell(status);
  if (pipeline_->sets_without_device() > 0) fill_device_failure(status);
  if (!sync_warning_.empty()) status.warnings.push_back(sync_warning_);
  if (flowing_.load() && !finished()) fill_silence(status, now_ns);
}

void Session::append_all_losses(std::vector<LossCount>& out) const {
  for (std::uint32_t c = 0; c < camera_names_.size(); ++c)
    append_losses(out, camera_names_[c], pipeline_->camera_losses(c));
  append_losses(out, "reconstruction", pipeline_->reconstruction_losses());
  append_losses(out, "pipeline", pipeline_->stage_losses());
  append_losses(out, "readers", reader_losses_);
}

std::vector<CameraReport> Session::camera_reports() const {
  std::vector<CameraReport> reports;
  for (DeviceStatus& device : pipeline_->source().device_status()) {
    const auto c = static_cast<std::uint32_t>(reports.size());
    reports.push_back({camera_names_[c], std::move(device), pipeline_->delivered(c), pipeline_->clock_mapping(c),
                       pipeline_->skew(c)});
  }
  return reports;
}

void Session::fill_device_failure(StatusReport& status) {
  status.warnings.push_back(device_failure(pipeline_->sets_without_device()));
  if (!std::exchange(device_failure_told_, true)) spdlog::warn("{}", status.warnings.back());
}

void Session::fill_silence(StatusReport& status, std::int64_t now_ns) {
  for (std::uint32_t c = 0; c < camera_names_.size(); ++c) {
    const DeviceStatus* device = c < status.cameras.size() ? &status.cameras[c].device : nullptr;
    const std::string line = alarm_->look(c, now_ns, pipeline_->delivered(c), device);
    if (!line.empty()) spdlog::warn("{}", line);
    if (!alarm_->warning(c).empty()) status.warnings.push_back(alarm_->warning(c));
  }
}

std::string Session::summary() {
  const std::int64_t now_ns = host_now_ns();
  const PipelineCounts now = counts();
  const auto lost = pipeline_->losses();
  const double linked = static_cast<double>(now.linked > 0 ? now.linked : 1);
  std::string line =
      fmt::format("{} frames, {:.1f} Hz, {:.0f} particles and {:.0f} tracks a frame, {} lost", now.linked,
                  rate_hz(now.linked, last_summary_.linked, now_ns - last_summary_ns_),
                  static_cast<double>(now.particles) / linked, static_cast<double>(now.track_points) / linked,
                  std::accumulate(lost.begin(), lost.end(), std::uint64_t{0}) + reader_losses_.total());
  last_summary_ns_ = now_ns;
  last_summary_ = now;
  return line;
}

SessionReport Session::report() const {
  SessionReport report;
  report.counts = counts();
  report.linker = pipeline_->linker().counters();
  append_all_losses(report.losses);
  for (std::size_t i = 0; i < kStageCount; ++i) report.latency[i] = summary_of(publisher_->latency()[i]);
  report.elapsed_s = seconds(stopped_ns_ - started_ns_);
  report.cameras = last_cameras_;
  report.sets_without_device = pipeline_->sets_without_device();
  report.source_failure = source_failure();
  return report;
}

}  // namespace rptv
