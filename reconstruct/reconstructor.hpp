// SPDX-License-Identifier: MIT
// The seam between frames and particles: light field and multi-view, CPU and CUDA, implement this.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/frame.hpp"
#include "core/losses.hpp"
#include "core/particles.hpp"
#include "core/tracks.hpp"

namespace rptv {

/// Set-up (constructor) throws Error and takes all memory; reconstruct() allocates nothing and never throws.
class Reconstructor {
 public:
  virtual ~Reconstructor() = default;
  /// Clears `out` and fills it with the particles of one instant, in order of falling support. One thread at a time.
  virtual void reconstruct(const FrameSet& frames, Particles& out) noexcept = 0;

  /// Begins with a frame set; collect() gives the particles of the first that was submitted, as reconstruct() would.
  /// The set, its frames and their order stay as they are until then. At most most_in_flight() at a time, which may
  /// fall with each collect(); beyond 1, work of the next overlaps that of the first. No reconstruct() in between.
  virtual void submit(const FrameSet& frames) noexcept { submitted_ = &frames; }
  virtual void collect(Particles& out) noexcept { reconstruct(*submitted_, out); }
  virtual std::size_t most_in_flight() const noexcept { return 1; }

  /// Frames to come lie in `memory`, which outlives this. Set-up only. False when page-locked memory would make it
  /// faster, and the system refuses that.
  virtual bool page_lock(std::span<std::byte> /*memory*/) noexcept { return true; }

  /// Whether it looks first where known tracks are expected; then expect() precedes every reconstruct().
  virtual bool uses_tracks() const noexcept { return false; }
  /// All live tracks, as expected at the exposure of the frame set that reconstruct() gets next (Linker::predict()).
  virtual void expect(const Tracks& /*expected*/) noexcept {}

  /// What was left out since construction; particles that `out` had no room for are not in it. Any thread.
  const Losses& losses() const noexcept { return losses_; }
  /// Frame sets that the CPU did alone since a GPU in use failed, with the same results; 0: none has. Any thread.
  std::uint64_t sets_without_device() const noexcept { return sets_without_device_.load(std::memory_order_relaxed); }

 protected:
  // Written by the reconstructing thread.
  void count_set_without_device() noexcept { sets_without_device_.fetch_add(1, std::memory_order_relaxed); }
  Losses losses_;

 private:
  const FrameSet* submitted_ = nullptr;
  std::atomic<std::uint64_t> sets_without_device_{0};
};

}  // namespace rptv
