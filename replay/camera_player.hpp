// SPDX-License-Identifier: MIT
// Plays one camera of a recording: its thread, what it delivers when, and the faults it adds.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "acquisition/source.hpp"
#include "replay/fault_plan.hpp"
#include "replay/pacer.hpp"
#include "replay/preload.hpp"
#include "replay/step_gate.hpp"
#include "replay/timeline.hpp"

namespace rptv {

/// The first thing that went wrong for good, written once by any thread without lock or allocation.
class FailureText {
 public:
  void set(const char* text) noexcept;
  std::string get() const { return written_.load(std::memory_order_acquire) ? text_.data() : ""; }

 private:
  std::array<char, 512> text_{};
  std::atomic<bool> taken_{false};
  std::atomic<bool> written_{false};
};

/// What the players of one replay share.
struct Play {
  Play(Timeline t, const ReplayFaults& faults, double speed, std::uint64_t total_loops)
      : timeline(std::move(t)),
        plan(faults),
        clock_jump_ns(faults.clock_jump_ns),
        steps(total_loops == 0 ? UINT64_MAX : total_loops * timeline.instants()),
        pacer(speed),
        gate(static_cast<std::uint32_t>(timeline.shots.size())) {}

  const Timeline timeline;
  const FaultPlan plan;
  const std::int64_t clock_jump_ns;
  const std::uint64_t steps;  ///< instants in all loops
  Pacer pacer;
  StepGate gate;
  FailureText failure;
};

/// run() belongs to one thread; the counters may be read by any.
class CameraPlayer {
 public:
  /// `decoded` null: images are decoded while playing, one ahead of its deadline.
  CameraPlayer(Play& play, std::uint32_t camera, const ImageSequence& images, const DecodedImages* decoded)
      : play_(play), camera_(camera), images_(images), decoded_(decoded), reader_(images) {}

  /// Plays all steps, or until the play is stopped.
  void run(FrameSink& sink) noexcept;

  InjectedFaults injected() const noexcept;
  std::uint64_t undecodable() const noexcept { return undecodable_.load(std::memory_order_relaxed); }
  std::int64_t worst_lateness_ns() const noexcept { return worst_lateness_ns_.load(std::memory_order_relaxed); }

 private:
  using Counter = std::atomic<std::uint64_t>;
  void play_step(FrameSink& sink, std::uint64_t step) noexcept;
  bool deliver(FrameSink& sink, const Shot& shot, std::uint64_t step, bool torn) noexcept;
  bool fill(std::size_t image, std::byte* pixels) noexcept;
  void tear(std::uint64_t step, std::byte* pixels) const noexcept;
  bool wait_for_turn(std::uint64_t step) noexcept;
  const Shot& shot_of(std::uint64_t step) const noexcept {
    return play_.timeline.shots[camera_][step % play_.timeline.instants()];
  }
  std::int64_t recorded_ns(std::uint64_t step) const noexcept;
  static void add(Counter& counter) noexcept { counter.fetch_add(1, std::memory_order_relaxed); }

  Play& play_;
  const std::uint32_t camera_;
  const ImageSequence& images_;
  const DecodedImages* decoded_;
  ImageSequence::Reader reader_;
  std::int64_t shifted_ns_ = 0;  // sum of the clock jumps so far
  Counter dropped_{0}, duplicated_{0}, torn_{0}, reordered_{0}, bunched_{0}, clock_jumps_{0};
  Counter undecodable_{0};
  std::atomic<std::int64_t> worst_lateness_ns_{0};
};

}  // namespace rptv
