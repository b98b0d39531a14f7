// SPDX-License-Identifier: MIT
// The light of Gaussians in the square of a spot: its own, and what its neighbours leave there.
#pragma once

#include <cstdint>
#include <span>

#include "core/instruction_set.hpp"
#include "reconstruct/detection/fitted_spot.hpp"
#include "reconstruct/detection/grey_over_background.hpp"
#include "reconstruct/detection/spot_fit.hpp"

namespace rptv {

/// In whole rows of SpotBatch::kRow pixels, as a batch has them; grey values.
struct alignas(64) CrowdedSquare {
  SpotBatch::Square others;  ///< light of the neighbours
  SpotBatch::Square weight;  ///< variance of a pixel with the spot's own light alone, over that with all light
  float others_sum;          ///< of the square
  float variance_sum;        ///< with all light, of the square
};

/// Gaussians of `spots[i]` and of `spots[k]` for k in `neighbours`, at the middles of the pixels round
/// spots[i].middle(). Same bits with every instruction set. Any thread.
void light_crowded_square(std::span<const FittedSpot> spots, std::size_t i, std::span<const std::uint32_t> neighbours,
                          std::int32_t radius, const GreyNoise& noise, CrowdedSquare& square,
                          InstructionSet set = best_instruction_set()) noexcept;

}  // namespace rptv
