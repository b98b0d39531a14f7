// SPDX-License-Identifier: MIT
// Multi-view reconstruction: particle images of 2 to 16 cameras → sets that meet → ghosts removed → fitted particles.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "reconstruct/detection/detect_device.hpp"
#include "reconstruct/detection/detections.hpp"
#include "reconstruct/multi_view/correspondence.hpp"
#include "reconstruct/multi_view/frame_gate.hpp"
#include "reconstruct/multi_view/view_observer.hpp"
#include "reconstruct/reconstructor.hpp"

namespace rptv {

/// Since construction, except where stated. Read on the reconstructing thread, or after it.
struct MultiViewCounts : FrameSetCounts {
  std::uint64_t refused_detections = 0, refused_particles = 0;  ///< beyond max_detections, max_particles
  bool device_failed = false;                                   ///< the CPU has done its work since
};

/// The seed's first instrument, eq. (3)-(4), for any subset of at least min_views cameras. Set-up takes all memory.
/// Particles are in the rig's frame; support is the number of views, ghost an estimate from the density of detections.
class MultiView final : public Reconstructor, public ObservableViews {
 public:
  /// `cameras`: the source's, in its order; each must be in the rig by name. `settings.rig` stands for the rig in
  /// messages and is not read here. `make_device`: the device that detects, if there is one. Throws
  /// Error(configuration), and what make_device throws.
  MultiView(const MultiViewSettings& settings, const Rig& rig, std::span<const MultiViewCamera> cameras,
            const MakeDetectDevice& make_device = {});
  ~MultiView() override;

  void reconstruct(const FrameSet& frames, Particles& out) noexcept override;
  /// The same from one list of detections per camera, in the order of `cameras`.
  void reconstruct(std::span<const Detections> seen, Particles& out) noexcept;

  void show_to(ViewObserver* observer) noexcept override;

  /// The last frame's detections, one list per camera.
  std::span<const Detections> detections() const noexcept;
  const MultiViewCounts& counts() const noexcept;
  const CorrespondenceCounts& correspondence_counts() const noexcept;
  const Volume& volume() const noexcept override;
  const std::vector<ViewRays>& rays() const noexcept override;

 private:
  struct Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace rptv
