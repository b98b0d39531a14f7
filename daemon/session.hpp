// SPDX-License-Identifier: MIT
// One run of the daemon: the pipeline with its publisher and writer, built from a configuration.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "acquisition/silence_alarm.hpp"
#include "daemon/config.hpp"
#include "daemon/drift_monitor.hpp"
#include "daemon/pipeline.hpp"
#include "daemon/publisher.hpp"
#include "daemon/result_writer.hpp"

namespace rptv {

/// What a finished run amounts to; printed by `run`, read by `demo`.
struct SessionReport {
  PipelineCounts counts;
  LinkerCounters linker;
  std::vector<LossCount> losses;
  std::vector<CameraReport> cameras;                  ///< those that are devices, as they were when the run was stopped
  std::array<LatencySummary, kStageCount> latency{};  ///< exposure end to each stage, as published
  double elapsed_s = 0;
  std::uint64_t sets_without_device = 0;  ///< done by the CPU after a GPU failed
  std::string source_failure;
};

/// Construction sets everything up and throws Error; start() lets frames flow. Main thread, except where stated.
class Session {
 public:
  explicit Session(const Config& config);
  /// With a source of the caller's own, and a reconstruction; null: the one that the configuration asks for.
  Session(const Config& config, std::unique_ptr<Source> source, std::unique_ptr<Reconstructor> reconstructor = nullptr);
  ~Session();

  const std::vector<std::string>& endpoints() const noexcept { return publisher_->endpoints(); }
  /// Which processor reconstructs, for people.
  const std::string& backend() const noexcept { return backend_text_; }
  /// Somebody has subscribed to tracks. Any thread.
  bool has_subscriber() const noexcept { return publisher_->has_subscriber(); }
  void start();
  /// The source has ended and every result is out.
  bool finished() const noexcept { return pipeline_->finished(); }
  /// Stops the source, drains, closes files. Throws Error(io) when a file could not be written. Idempotent.
  void stop();

  PipelineCounts counts() const noexcept { return pipeline_->counts(); }
  /// No frame is being worked on: no progress is no fault.
  bool idle() const noexcept { return pipeline_->idle(); }
  std::string source_failure() const { return pipeline_->source().failure(); }
  /// One line for people: frames, rate, particles, tracks, losses.
  std::string summary();
  /// Valid after stop().
  SessionReport report() const;

 private:
  void fill_status(StatusReport& status);
  void fill_device_failure(StatusReport& status);
  void fill_silence(StatusReport& status, std::int64_t now_ns);
  std::vector<CameraReport> camera_reports() const;
  void append_all_losses(std::vector<LossCount>& out) const;

  Losses reader_losses_;  // of publisher and writer
  std::vector<std::string> camera_names_;
  std::vector<CameraReport> last_cameras_;  // before the source was stopped
  std::string sync_warning_, backend_text_;
  std::unique_ptr<SilenceAlarm> alarm_;  // publisher's thread only
  std::atomic<bool> flowing_{false};     // between start() and stop()
  std::unique_ptr<DriftMonitor> drift_;  // null where nobody watches
  bool device_failure_told_ = false;     // publisher's thread only
  std::unique_ptr<Pipeline> pipeline_;
  std::unique_ptr<Publisher> publisher_;
  std::unique_ptr<ResultWriter> writer_;
  std::int64_t started_ns_ = 0, stopped_ns_ = 0;
  std::int64_t last_status_ns_ = 0;  // publisher's thread only
  PipelineCounts last_status_;       // publisher's thread only
  std::int64_t last_summary_ns_ = 0;
  PipelineCounts last_summary_;
};

/// The source, and the reconstruction for its cameras, that the configuration asks for. Throw Error.
std::unique_ptr<Source> make_source(const Config& config);
/// `where` becomes a line for people about the processor that reconstructs.
std::unique_ptr<Reconstructor> make_reconstructor(const Config& config, const std::vector<CameraInfo>& cameras,
                                                  std::string* where = nullptr);
/// How the source's frames come in, and how its cameras are paired: a recording by index, live ones as [sync] says.
/// Throws Error(configuration).
IntakeOptions make_intake_options(const Config& config, const Source& source);
/// What every status says about the way live cameras are paired; empty when that is in order.
std::string sync_warning(const Config& config, const Source& source);

/// The report as text for people, and as one JSON object.
std::string to_text(const SessionReport& report);
std::string to_json(const SessionReport& report);

}  // namespace rptv
