// SPDX-License-Identifier: MIT
// Image files of several cameras, one instant at a time, as a source would deliver them.
#pragma once

#include <deque>
#include <vector>

#include "acquisition/source.hpp"
#include "core/frame.hpp"
#include "replay/image_sequence.hpp"
#include "replay/timeline.hpp"

namespace rptv {

/// What the source of these images would say of its cameras.
std::vector<CameraInfo> infos_of(const std::vector<ImageSequence>& cameras);

/// Owns one frame a camera. One thread.
class Instants {
 public:
  /// `cameras` must outlive this.
  explicit Instants(const std::vector<ImageSequence>& cameras);
  ~Instants() { set_.reset(); }
  Instants(const Instants&) = delete;
  Instants& operator=(const Instants&) = delete;

  /// A camera without an image of this instant has a frame without pixels. Valid until the next call. Throws Error for
  /// an image that cannot be decoded.
  const FrameSet& load(const Timeline& timeline, std::size_t instant);

 private:
  std::deque<FramePool> pools_;
  std::deque<ImageSequence::Reader> readers_;
  FrameSet set_;
};

}  // namespace rptv
