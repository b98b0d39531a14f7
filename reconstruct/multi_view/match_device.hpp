// SPDX-License-Identifier: MIT
// What a GPU may do after detection: which particle images of the cameras are one particle.
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "reconstruct/detection/detections.hpp"
#include "reconstruct/multi_view/correspondence.hpp"
#include "reconstruct/multi_view/view_setup.hpp"

namespace rptv {

/// Correspondence::match() and the choice that ghosts = "views" makes, on another processor. Set-up takes all memory.
/// One thread calls; match() returns when it is done, and is false when the device fails: MultiView then goes on with
/// the CPU and does not ask again.
class MatchDevice {
 public:
  virtual ~MatchDevice() = default;

  /// One list per view. `matches`: those chosen, with the bits of the CPU, valid until the next call, as views();
  /// `counts`: as Correspondence::counts(), with what there was no room for. What is left of a set that lost particle
  /// images to others may be chosen earlier than by the CPU.
  virtual bool match(std::span<const Detections> seen, std::span<const ViewMatch>& matches,
                     CorrespondenceCounts& counts) noexcept = 0;
  virtual std::span<const SeenView> views() const noexcept = 0;
};

/// What a device is set up for. `rays` and `volume` live as long as it does, the others until it is set up.
struct MatchDevicePlan {
  const MultiViewSettings& settings;
  const Rig& rig;
  std::span<const MultiViewCamera> cameras;
  std::span<const ViewRays> rays;
  const Volume& volume;
};

/// May give null. Throws Error(unavailable) when the device cannot be used.
using MakeMatchDevice = std::function<std::unique_ptr<MatchDevice>(const MatchDevicePlan&)>;

}  // namespace rptv
