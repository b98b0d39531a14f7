// SPDX-License-Identifier: MIT
// Whose light falls into the square of which spot.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "reconstruct/detection/fitted_spot.hpp"
#include "reconstruct/detection/near_pairs.hpp"

namespace rptv {

/// Lists of the modelled spots near each crowded one. All memory is taken by the constructor. One thread.
class SpotNeighbours {
 public:
  static constexpr std::int32_t kMove = 1;  ///< px that two may come nearer to each other before the next find()
  static constexpr std::size_t kRoom = 48;  ///< pairs for each crowded spot, on average

  SpotNeighbours(std::size_t most_spots, std::size_t most_crowded, InstructionSet set);

  /// Lists for squares of 2·radius + 1 pixels; ModelImage::reach() says how far a Gaussian is seen. False when there is
  /// no room for all pairs: of() is then not to be asked.
  bool find(std::span<const FittedSpot> spots, std::int32_t radius) noexcept;

  /// Numbers of the others whose Gaussians reach the square of crowded spot number i, as of the last find().
  std::span<const std::uint32_t> of(std::size_t i) const noexcept {
    return std::span(lists_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
  }

 private:
  const NearColumns near_columns_;
  std::vector<std::uint32_t> modelled_;                           // numbers of spots, in raster order of their starts
  std::vector<PixelIndex> starts_;                                // of the same
  std::vector<std::int32_t> reach_px_;                            // of the same: how far their light is seen
  std::vector<std::pair<std::uint32_t, std::uint32_t>> entries_;  // a crowded spot, and one that it sees
  std::vector<std::uint32_t> begin_, lists_;
};

}  // namespace rptv
