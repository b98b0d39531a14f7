// SPDX-License-Identifier: MIT
// The pipeline's two loops. Nothing in them allocates, locks or throws.
#include "daemon/pipeline.hpp"

#include <pthread.h>

namespace rptv {

Pipeline::Pipeline(std::unique_ptr<Source> source, std::unique_ptr<Reconstructor> reconstructor,
                   const LinkerSettings& linker, const PipelineOptions& options)
    : intake_(source->cameras(), options.intake),
      source_(std::move(source)),
      reconstructor_(std::move(reconstructor)),
      linker_(linker),
      lossless_(std::holds_alternative<Lossless>(options.intake.policy)),
      in_turns_(reconstructor_->uses_tracks()),
      expected_(in_turns_ ? linker_.capacity() : 0),
      results_(options.results_in_flight, [&] { return Result(options.max_particles, linker_.capacity()); }),
      to_linker_(Lossless{4}, losses_) {}

Pipeline::~Pipeline() { stop(); }

void Pipeline::start() {
  started_ = true;
  last_progress_ns_.store(host_now_ns(), std::memory_order_relaxed);
  link_thread_ = std::thread([this] { link_loop(); });
  reconstruct_thread_ = std::thread([this] { reconstruct_loop(); });
  pthread_setname_np(link_thread_.native_handle(), "rptv-link");
  pthread_setname_np(reconstruct_thread_.native_handle(), "rptv-rebuild");
  source_->start(intake_);
}

void Pipeline::stop() noexcept {
  if (!started_) return;
  started_ = false;
  // Closing first frees a source that waits for a slot; what was delivered before is still drained by the loops.
  intake_.close();
  source_->stop();
  reconstruct_thread_.join();
  link_thread_.join();
}

ResultLease Pipeline::claim_result() noexcept {
  while (true) {
    const std::uint32_t seen = results_.prepare_to_wait();
    ResultLease result = results_.claim();
    if (result || !lossless_) return result;
    results_.wait_for_slot(seen, kPatienceNs);
  }
}

void Pipeline::reconstruct_loop() noexcept {
  FrameSet frames;
  for (Taken taken; (taken = intake_.next(frames, kPatienceNs)) != Taken::closed; frames.reset()) {
    if (taken == Taken::timeout) continue;
    taken_.fetch_add(1, std::memory_order_relaxed);
    ResultLease result = claim_result();
    if (!result) {
      losses_.count(LossCause::result_pool_empty);
      continue;
    }
    const FrameInfo& info = frames.info();
    result->frame = info.index;
    result->exposure_end_ns = info.exposure_end_ns;
    result->clock = info.clock;
    result->stamps = Stamps{};
    result->stamps[Stage::exposure_end] = info.exposure_end_host_ns;
    for (const Frame& frame : frames.all())
      if (frame.info.arrival_ns > result->stamps[Stage::arrived])
        result->stamps[Stage::arrived] = frame.info.arrival_ns;
    result->stamps[Stage::bundled] = host_now_ns();
    reconstruct(frames, *result);
    if (result->particles.overflow() != 0) losses_.count(LossCause::particle_overflow, result->particles.overflow());
    particles_.fetch_add(result->particles.size(), std::memory_order_relaxed);
    reconstructed_.fetch_add(1, std::memory_order_relaxed);
    to_linker_.push(std::move(result));
  }
  to_linker_.close();
}

void Pipeline::reconstruct(const FrameSet& frames, Result& result) noexcept {
  if (in_turns_) {
    linker_.predict(result.exposure_end_ns, expected_);
    reconstructor_->expect(expected_);
  }
  reconstructor_->reconstruct(frames, result.particles);
  result.stamps[Stage::reconstructed] = host_now_ns();
  if (in_turns_) link(result);
}

void Pipeline::link(Result& result) noexcept {
  linker_.next(result.particles, result.frame, result.exposure_end_ns, result.tracks);
  result.stamps[Stage::linked] = host_now_ns();
}

void Pipeline::link_loop() noexcept {
  ResultLease result;
  for (Taken taken; (taken = to_linker_.pop(result, kPatienceNs)) != Taken::closed;) {
    if (taken == Taken::timeout) continue;
    if (!in_turns_) link(*result);
    if (result->tracks.overflow() != 0) losses_.count(LossCause::track_overflow, result->tracks.overflow());
    if (result->tracks.cut_subnets != 0) losses_.count(LossCause::linking_cut, result->tracks.cut_subnets);
    track_points_.fetch_add(result->tracks.size(), std::memory_order_relaxed);
    births_.fetch_add(result->tracks.births.size(), std::memory_order_relaxed);
    linked_.fetch_add(1, std::memory_order_relaxed);
    last_progress_ns_.store(result->stamps[Stage::linked], std::memory_order_relaxed);
    for (const ResultReader& reader : readers_) reader(result.share());
    result.reset();
  }
  finished_.store(true, std::memory_order_release);
}

bool Pipeline::idle() const noexcept {
  const std::uint64_t left = linked_.load(std::memory_order_relaxed) + losses_.of(LossCause::result_pool_empty);
  return taken_.load(std::memory_order_relaxed) <= left;
}

PipelineCounts Pipeline::counts() const noexcept {
  PipelineCounts counts;
  for (std::uint32_t c = 0; c < intake_.cameras(); ++c) counts.arrived += intake_.delivered(c);
  counts.reconstructed = reconstructed_.load(std::memory_order_relaxed);
  counts.linked = linked_.load(std::memory_order_relaxed);
  counts.particles = particles_.load(std::memory_order_relaxed);
  counts.track_points = track_points_.load(std::memory_order_relaxed);
  counts.births = births_.load(std::memory_order_relaxed);
  counts.last_progress_ns = last_progress_ns_.load(std::memory_order_relaxed);
  return counts;
}

std::array<std::uint64_t, kLossCauseCount> Pipeline::losses() const noexcept {
  auto sum = losses_.snapshot();
  const auto add = [&sum](const Losses& losses) {
    const auto counts = losses.snapshot();
    for (std::size_t i = 0; i < kLossCauseCount; ++i) sum[i] += counts[i];
  };
  add(reconstruction_losses());
  for (std::uint32_t c = 0; c < intake_.cameras(); ++c) add(intake_.losses(c));
  return sum;
}

}  // namespace rptv
