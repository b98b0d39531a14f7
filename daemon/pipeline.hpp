// SPDX-License-Identifier: MIT
// The only place where the stages meet: source → intake → reconstruct → link → readers, each on its own thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "acquisition/intake.hpp"
#include "core/result.hpp"
#include "reconstruct/reconstructor.hpp"
#include "tracking/linker.hpp"

namespace rptv {

struct PipelineOptions {
  IntakeOptions intake;
  std::size_t results_in_flight = 24;  ///< must exceed the sum of the readers' queue depths
  std::size_t max_particles = 4096;
};

/// Counters at some moment; every frame that arrived is in `linked` or in one of the losses.
struct PipelineCounts {
  std::uint64_t arrived = 0, reconstructed = 0, linked = 0;
  std::uint64_t particles = 0, track_points = 0, births = 0;
  std::int64_t last_progress_ns = 0;  ///< host time at which a result was last handed to the readers
};

/// Takes one result; called on the linking thread, in frame order. It may wait only where losing is worse (a file under
/// policy `lossless`); it must not allocate or throw, and must not change the result: others hold leases on it too.
using ResultReader = std::function<void(ResultLease&&)>;

/// Construction and readers are set up by the main thread; start() once, then stop() once (or the destructor).
class Pipeline {
 public:
  /// Throws Error when memory or a stage cannot be set up.
  Pipeline(std::unique_ptr<Source> source, std::unique_ptr<Reconstructor> reconstructor, const LinkerSettings& linker,
           const PipelineOptions& options);
  ~Pipeline();

  /// Before start() only. What it refers to must outlive stop().
  void add_reader(ResultReader reader) { readers_.push_back(std::move(reader)); }

  /// False when the reconstruction wants frames in page-locked memory and the system refuses: it is slower then.
  bool frames_locked() const noexcept { return frames_locked_; }

  void start();
  /// Stops the source, drains what is in flight and joins the threads. Idempotent; main thread.
  void stop() noexcept;
  /// The source has ended and every reader has had the last result. Any thread.
  bool finished() const noexcept { return finished_.load(std::memory_order_acquire); }

  PipelineCounts counts() const noexcept;
  /// Every frame set that was taken from the intake has left the pipeline. Any thread.
  bool idle() const noexcept;
  /// Losses of the whole pipeline by cause, all cameras together. Any thread.
  std::array<std::uint64_t, kLossCauseCount> losses() const noexcept;
  const Losses& camera_losses(std::uint32_t camera) const noexcept { return intake_.losses(camera); }
  std::uint64_t delivered(std::uint32_t camera) const noexcept { return intake_.delivered(camera); }
  ClockMapping clock_mapping(std::uint32_t camera) const noexcept { return intake_.clock_mapping(camera); }
  ClockSkew skew(std::uint32_t camera) const noexcept { return intake_.skew(camera); }
  const Losses& stage_losses() const noexcept { return losses_; }
  const Losses& reconstruction_losses() const noexcept { return reconstructor_->losses(); }
  std::uint64_t sets_without_device() const noexcept { return reconstructor_->sets_without_device(); }
  const Source& source() const noexcept { return *source_; }
  const Linker& linker() const noexcept { return linker_; }  ///< its counters: after stop()

 private:
  void reconstruct_loop() noexcept;
  void link_loop() noexcept;
  void reconstruct(const FrameSet& frames, Result& result) noexcept;
  void link(Result& result) noexcept;
  ResultLease claim_result() noexcept;

  static constexpr std::int64_t kPatienceNs = 100'000'000;

  Intake intake_;
  std::unique_ptr<Source> source_;
  std::unique_ptr<Reconstructor> reconstructor_;
  bool frames_locked_ = true;
  Linker linker_;
  const bool lossless_;
  const bool in_turns_;  ///< the reconstruction asks for expected tracks: its thread links, too
  Tracks expected_;
  Losses losses_;  // of the stages after intake
  ResultPool results_;
  HandOver<ResultLease> to_linker_;
  std::vector<ResultReader> readers_;
  std::thread reconstruct_thread_, link_thread_;
  bool started_ = false;
  std::atomic<bool> finished_{false};
  std::atomic<std::uint64_t> taken_{0}, reconstructed_{0}, linked_{0}, particles_{0}, track_points_{0}, births_{0};
  std::atomic<std::int64_t> last_progress_ns_{0};
};

}  // namespace rptv
