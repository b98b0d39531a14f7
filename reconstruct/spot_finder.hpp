// SPDX-License-Identifier: MIT
// Small particle images: bright maxima, which of them are particles of their own, and their sub-pixel centres.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/image.hpp"
#include "reconstruct/detections.hpp"
#include "reconstruct/detector_counts.hpp"
#include "reconstruct/detector_settings.hpp"
#include "reconstruct/grey_over_background.hpp"
#include "reconstruct/spot_fit.hpp"

namespace rptv {

/// All memory is taken by the constructor. One thread.
class SpotFinder {
 public:
  SpotFinder(const DetectorSettings& settings, InstructionSet set);

  /// Appends what it finds in an image of dark.limit.size() pixels to `out`, in the raster order of the maxima.
  template <class Pixel>
  void find(const ImageView& image, const DarkPixels& dark, Detections& out, DetectorCounts& counts) noexcept;

 private:
  struct Spot {
    PixelIndex middle;                                      ///< of the square
    std::uint64_t neighbours = 0;                           ///< bit k: pixel k of the square belongs to another spot
    double plateau_x = 0, plateau_y = 0, plateau_rows = 0;  ///< saturated pixels; rows: 0 when there are none
  };

  template <class Pixel>
  void drop_noise(const GreyOverBackground<Pixel>& grey, DetectorCounts& counts) noexcept;
  template <class Pixel>
  void place_squares(const GreyOverBackground<Pixel>& grey) noexcept;
  void share_pixels() noexcept;
  template <class Pixel>
  void fill(const GreyOverBackground<Pixel>& grey, const Spot& spot, std::size_t lane) noexcept;
  template <class Pixel>
  bool fill_plain(const GreyOverBackground<Pixel>& grey, const Spot& spot, std::size_t lane) noexcept;
  void push(std::size_t lanes, Detections& out) noexcept;

  const InstructionSet set_;
  const SpotOptions options_;
  const GreyNoise noise_;
  const float split_sigmas_;
  const double saturation_grey_;
  const std::size_t min_area_px_;
  std::vector<PixelIndex> room_;
  std::span<PixelIndex> maxima_;                            // of this image, within room_
  std::vector<std::uint8_t> dropped_;                       // per maximum
  std::vector<Spot> spots_;                                 // one a maximum
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;  // of maxima near each other
  SpotBatch batch_{};
  SpotCentres centres_{};
  struct Lane {
    const Spot* spot;
    std::size_t lit, usable;
  };
  std::array<Lane, SpotBatch::kSpots> lanes_{};
};

}  // namespace rptv
