// SPDX-License-Identifier: MIT
// The front end of multi-view: one camera's frame in, the list of its particle images out.
#pragma once

#include <memory>

#include "core/image.hpp"
#include "core/instruction_set.hpp"
#include "reconstruct/dark_pixels.hpp"
#include "reconstruct/detection/detections.hpp"
#include "reconstruct/detection/detector_counts.hpp"
#include "reconstruct/detection/detector_settings.hpp"

namespace rptv {

/// Background and limit of camera number `camera`, counted from 0, as its settings say.
DarkSettings dark_settings(const DetectorSettings& settings, std::size_t camera);

/// Of one camera. detect() allocates nothing, takes no lock and copies no frame; its time is bounded by the image's
/// size and by settings.max_detections. One thread at a time (a running background learns on a thread of its own).
class Detector {
 public:
  /// Images will have `shape`'s width and height, 8 or 16 bit. `background`: an image without particles, read here
  /// only; without data, the constant settings.background. `camera` counts from 0 and names the background image in
  /// messages. Throws Error(configuration) when the background has another shape.
  Detector(const DetectorSettings& settings, const ImageShape& shape, const ImageView& background = {},
           std::size_t camera = 0, InstructionSet set = best_instruction_set());
  ~Detector();
  Detector(Detector&&) noexcept;
  Detector& operator=(Detector&&) noexcept;

  /// Replaces what is in `out`; images of another shape leave it empty and are counted. What does not fit, into `out`
  /// or into settings.max_detections, is counted in out.overflow(). The same bits with every instruction set.
  void detect(const ImageView& image, Detections& out) noexcept;

  /// Totals since the start; from the thread that detects.
  const DetectorCounts& counts() const noexcept;

 private:
  struct Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace rptv
