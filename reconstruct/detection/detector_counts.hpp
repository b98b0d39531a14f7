// SPDX-License-Identifier: MIT
// How detection fared: what was left out, and why.
#pragma once

#include <cstdint>

namespace rptv {

/// Since the start.
struct DetectorCounts {
  std::uint64_t frames = 0, refused_frames = 0;  ///< refused: of another shape
  std::uint64_t refused_maxima = 0;              ///< for which there was no room
  std::uint64_t refused_runs = 0;                ///< of lit pixels, for which there was no room; blobs only
  std::uint64_t merged = 0;                      ///< maxima in the noise of a brighter one's image
  std::uint64_t too_crowded = 0;                 ///< spots in frames with more overlaps than are untangled
  std::uint64_t too_small = 0, too_large = 0;    ///< particle images by their lit pixels
  std::uint64_t at_border = 0;                   ///< blobs that the image's border cuts
};

}  // namespace rptv
