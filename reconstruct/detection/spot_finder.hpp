// SPDX-License-Identifier: MIT
// Small particle images: bright maxima, which of them are particles of their own, and their sub-pixel centres.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/image.hpp"
#include "reconstruct/detection/detections.hpp"
#include "reconstruct/detection/detector_counts.hpp"
#include "reconstruct/detection/detector_settings.hpp"
#include "reconstruct/detection/fitted_spot.hpp"
#include "reconstruct/detection/grey_over_background.hpp"
#include "reconstruct/detection/separate_spots.hpp"
#include "reconstruct/detection/spot_fit.hpp"
#include "reconstruct/detection/spot_overlaps.hpp"

namespace rptv {

inline constexpr std::size_t kMaximaPerDetection = 4;  ///< that there is room for

/// What a user's settings mean for the fit of spots.
SpotOptions spot_options(const DetectorSettings& settings);

/// All memory is taken by the constructor. One thread.
class SpotFinder {
 public:
  SpotFinder(const DetectorSettings& settings, const ImageShape& shape, InstructionSet set);

  /// Appends what it finds in an image of dark.limit.size() pixels to `out`, in the raster order of the
  /// maxima, and after them those that hid in another's image.
  template <class Pixel>
  void find(const ImageView& image, const DarkPixels& dark, Detections& out, DetectorCounts& counts) noexcept;

 private:
  template <class Pixel>
  void fill(const GreyOverBackground<Pixel>& grey, const Spot& spot, std::size_t lane) noexcept;
  template <class Pixel>
  void fill_with_care(const GreyOverBackground<Pixel>& grey, const Spot& spot, std::size_t lane) noexcept;
  void fit(std::size_t lanes) noexcept;
  template <class Pixel>
  void fit_all(const GreyOverBackground<Pixel>& grey, std::span<const Spot> spots, DetectorCounts& counts) noexcept;

  struct Lane {
    const Spot* spot;
    std::size_t lit, usable;  // pixels
  };

  const InstructionSet set_;
  const SpotOptions options_;
  const double saturation_grey_;
  const std::size_t min_area_px_;
  std::vector<PixelIndex> maxima_;
  SeparateSpots separate_;
  std::vector<FittedSpot> fitted_;
  std::optional<SpotOverlaps> overlaps_;
  SpotBatch batch_{};
  SpotCentres centres_{};
  std::array<Lane, SpotBatch::kSpots> lanes_{};
};

}  // namespace rptv
