// SPDX-License-Identifier: MIT
// The seam between frames and particles: light field and multi-view, CPU and CUDA, implement this.
#pragma once

#include "core/frame.hpp"
#include "core/particles.hpp"

namespace rptv {

/// Set-up (constructor) throws Error and takes all memory; reconstruct() allocates nothing and never throws.
class Reconstructor {
 public:
  virtual ~Reconstructor() = default;
  /// Clears `out` and fills it with the particles of one instant, in order of falling support. One thread at a time.
  virtual void reconstruct(const FrameSet& frames, Particles& out) noexcept = 0;
};

}  // namespace rptv
