// SPDX-License-Identifier: MIT
// Which bright maxima are particles of their own, and which pixels tell their centres.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "reconstruct/detection/detector_settings.hpp"
#include "reconstruct/detection/grey_over_background.hpp"
#include "reconstruct/detection/lit_maxima.hpp"
#include "reconstruct/detection/near_columns.hpp"

namespace rptv {

struct Spot {
  PixelIndex middle;             ///< of the square that tells its centre
  std::uint64_t neighbours = 0;  ///< bit k: pixel k of the square belongs to another spot
  bool merged = false;           ///< no spot but noise in a brighter one's image
  float nearest_px2 = 1e9F;      ///< squared distance of the nearest other one within crowd_reach()
  double plateau_x = 0, plateau_y = 0, plateau_rows = 0;  ///< saturated pixels; rows: 0 when there are none
};

/// How far, in x and in y, a maximum may be from the one that it is noise on.
inline std::int32_t merge_reach(std::int32_t radius) noexcept { return 2 * radius + 1; }
/// How far others are looked for whose light may fall into a spot's square.
inline std::int32_t crowd_reach(std::int32_t radius) noexcept { return 2 * radius + 8; }

/// All memory is taken by the constructor. One thread.
class SeparateSpots {
 public:
  SeparateSpots(const DetectorSettings& settings, std::size_t most_maxima, InstructionSet set);

  /// One spot for each of the maxima, which are in raster order and no more than there is room for.
  template <class Pixel>
  std::span<const Spot> separate(const GreyOverBackground<Pixel>& grey, std::span<const PixelIndex> maxima) noexcept;

 private:
  template <class Pixel>
  void place_squares(const GreyOverBackground<Pixel>& grey, std::span<const PixelIndex> maxima) noexcept;
  template <class Pixel>
  void drop_noise(const GreyOverBackground<Pixel>& grey, std::span<const PixelIndex> maxima) noexcept;
  void share_pixels() noexcept;

  const std::int32_t radius_, reach_;
  const float split_sigmas_;
  const GreyNoise noise_;
  const NearColumns near_columns_;
  std::vector<Spot> spots_;
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;  // of maxima near each other
};

}  // namespace rptv
