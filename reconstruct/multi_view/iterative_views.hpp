// SPDX-License-Identifier: MIT
// Iterative particle reconstruction: particles are found in what is left of the images, and all are fitted together.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "reconstruct/multi_view/correspondence.hpp"
#include "reconstruct/multi_view/frame_gate.hpp"
#include "reconstruct/multi_view/view_observer.hpp"
#include "reconstruct/reconstructor.hpp"

namespace rptv {

/// Since construction, except where stated. Read on the reconstructing thread, or after it.
struct IterativeCounts : FrameSetCounts {
  std::uint64_t refused_peaks = 0;       ///< maxima of residual images beyond max_detections
  std::uint64_t refused_places = 0;      ///< where particles may be, beyond the room for them
  std::uint64_t refused_particles = 0;   ///< beyond max_particles
  std::uint64_t expected = 0;            ///< places of tracks that were looked at first
  std::uint64_t found = 0, dropped = 0;  ///< particles over all rounds: taken up, and let go again
};

/// Wieneke, Meas. Sci. Technol. 24 (2013) 024008; Jahn, Schanz & Schröder, Exp. Fluids 62 (2021) 179. Each round
/// searches the residual images for maxima, matches them, and then shakes all particles. Set-up takes all memory; the
/// rounds and sweeps of a frame are fixed. Particles are in the rig's frame; support is the number of views that see
/// one.
class IterativeViews final : public Reconstructor, public ObservableViews {
 public:
  /// As MultiView's. Throws Error(configuration).
  IterativeViews(const MultiViewSettings& settings, const Rig& rig, std::span<const MultiViewCamera> cameras);
  ~IterativeViews() override;

  void reconstruct(const FrameSet& frames, Particles& out) noexcept override;
  /// With settings.iterative.use_tracks. Those of one frame have no velocity yet, and are not looked for.
  bool uses_tracks() const noexcept override;
  void expect(const Tracks& expected) noexcept override;
  /// Maxima of the images before any round; found only for an observer who wants them.
  void show_to(ViewObserver* observer) noexcept override;
  const Volume& volume() const noexcept override;
  const std::vector<ViewRays>& rays() const noexcept override;

  const IterativeCounts& counts() const noexcept;
  const CorrespondenceCounts& correspondence_counts() const noexcept;

 private:
  struct Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace rptv
