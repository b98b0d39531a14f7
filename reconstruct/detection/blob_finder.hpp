// SPDX-License-Identifier: MIT
// Large particle images (beans): connected lit pixels, taken apart where they overlap, and their ellipses.
#pragma once

#include <vector>

#include "reconstruct/detection/blob_parts.hpp"
#include "reconstruct/detection/detections.hpp"
#include "reconstruct/detection/detector_counts.hpp"
#include "reconstruct/detection/detector_settings.hpp"
#include "reconstruct/detection/lit_components.hpp"

namespace rptv {

/// All memory is taken by the constructor. One thread.
class BlobFinder {
 public:
  BlobFinder(const DetectorSettings& settings, const ImageShape& shape, InstructionSet set);

  /// Appends what it finds in an image of dark.limit.size() pixels to `out`: component by component in raster order, in
  /// each the brightest part first. A component that touches the border, whose centre is elsewhere, is counted only.
  template <class Pixel>
  void find(const ImageView& image, const DarkPixels& dark, Detections& out, DetectorCounts& counts) noexcept;

 private:
  /// Sums over the pixels of a part, x and y from the component's first pixel: whole numbers, so in any order the same.
  struct Moments {
    double pixels = 0, grey = 0;
    double light = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;    ///< weighted by the grey over the limit
    double noise = 0, noise_x = 0, noise_y = 0, noise_rr = 0;  ///< weighted by the grey's variance
  };

  bool is_whole(std::span<const LitRun> component, const ImageShape& shape, DetectorCounts& counts) const noexcept;
  void measure(const LitRun& origin, std::uint32_t parts) noexcept;
  void push(const LitRun& origin, const Moments& m, Detections& out, DetectorCounts& counts) const noexcept;

  const InstructionSet set_;
  const GreyNoise noise_;
  const std::size_t min_area_px_, max_area_px_;
  std::vector<LitRun> runs_;
  LitComponents components_;
  BlobParts parts_;
  std::vector<Moments> moments_;  // per part
};

}  // namespace rptv
