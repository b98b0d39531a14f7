// SPDX-License-Identifier: MIT
// Somebody who looks over the shoulder of a reconstruction from several views, and what can be looked at.
#pragma once

#include <span>
#include <vector>

#include "reconstruct/detection/detections.hpp"
#include "reconstruct/multi_view/view_rays.hpp"

namespace rptv {

class ViewObserver {
 public:
  virtual ~ViewObserver() = default;
  /// Whether it looks at the next frame set; where not, the set has been passed over, and see() need not be called: for
  /// those to whom a list of detections is work. Reconstructing thread: must neither wait nor allocate.
  virtual bool wants() noexcept { return true; }
  /// One list of particle images per camera (px), valid during the call. Reconstructing thread, once a frame set: must
  /// neither wait nor allocate.
  virtual void see(std::span<const Detections> views) noexcept = 0;
};

/// A reconstruction from several views that shows what it sees.
class ObservableViews {
 public:
  virtual ~ObservableViews() = default;
  /// Shows it the particle images of every frame set from now on, as they are before any of them is explained; null:
  /// nobody. It outlives this, or the next call. Set-up, or between two frames.
  virtual void show_to(ViewObserver* observer) noexcept = 0;
  /// What is searched for particles, rig's frame.
  virtual const Volume& volume() const noexcept = 0;
  /// Of every camera, in that volume.
  virtual const std::vector<ViewRays>& rays() const noexcept = 0;
};

}  // namespace rptv
