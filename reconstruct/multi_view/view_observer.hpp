// SPDX-License-Identifier: MIT
// Somebody who looks over the shoulder of a reconstruction from several views.
#pragma once

#include <span>

#include "reconstruct/detection/detections.hpp"

namespace rptv {

class ViewObserver {
 public:
  virtual ~ViewObserver() = default;
  /// One list of particle images per camera (px), valid during the call. Reconstructing thread, once a frame set: must
  /// neither wait nor allocate.
  virtual void see(std::span<const Detections> views) noexcept = 0;
};

}  // namespace rptv
