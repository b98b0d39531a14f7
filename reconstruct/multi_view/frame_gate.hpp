// SPDX-License-Identifier: MIT
// Which images of a frame set can be used, and which sets; what cannot is counted.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/frame.hpp"
#include "reconstruct/multi_view/view_setup.hpp"

namespace rptv {

/// Since construction. Read on the reconstructing thread, or after it.
struct FrameSetCounts {
  std::uint64_t frames = 0;          ///< reconstructed
  std::uint64_t refused_frames = 0;  ///< sets of another number of cameras than the source has
  std::uint64_t refused_views = 0;   ///< images that were missing, torn, or of another shape; the set goes on without
  std::uint64_t too_few_views = 0;   ///< sets where fewer than min_views were left
};

/// One thread.
class FrameGate {
 public:
  FrameGate(std::span<const MultiViewCamera> cameras, std::size_t min_views) : min_views_(min_views) {
    for (const MultiViewCamera& camera : cameras) shapes_.push_back(camera.shape);
  }
  std::size_t cameras() const noexcept { return shapes_.size(); }

  bool usable(const Frame& frame, std::size_t camera) const noexcept {
    return frame.view().data != nullptr && !frame.info.torn && frame.shape.has_size_of(shapes_[camera]);
  }
  /// How many images of the set are usable; 0, and counted, when that is too few.
  std::size_t admit(const FrameSet& frames, FrameSetCounts& counts) const noexcept {
    if (frames.cameras != shapes_.size()) {
      ++counts.refused_frames;
      return 0;
    }
    std::size_t views = 0;
    for (std::size_t c = 0; c < shapes_.size(); ++c) views += usable(frames.frames[c], c) ? 1 : 0;
    counts.refused_views += shapes_.size() - views;
    if (views >= min_views_) return views;
    ++counts.too_few_views;
    return 0;
  }

 private:
  std::vector<ImageShape> shapes_;
  std::size_t min_views_;
};

}  // namespace rptv
