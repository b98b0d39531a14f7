// SPDX-License-Identifier: MIT
// The square of a spot copied out of an image, where nothing is in its way.
#pragma once

#include <cstddef>

#include "core/instruction_set.hpp"
#include "reconstruct/detection/grey_over_background.hpp"
#include "reconstruct/detection/spot_fit.hpp"

namespace rptv {

/// Pixels of a square.
struct SquareCounts {
  std::size_t lit = 0;        ///< above the limit of the middle one
  std::size_t saturated = 0;  ///< that tell nothing
};

/// Copies the grey over the background of the square round `middle`, all of which is in the image, in whole rows of
/// SpotBatch::kRow pixels: what is right of the square holds whatever is there. Same bits with every instruction set.
template <class Pixel>
SquareCounts copy_square(const GreyOverBackground<Pixel>& grey, PixelIndex middle, std::int32_t radius,
                         SpotBatch::Square& square, InstructionSet set) noexcept;

/// The image goes on behind the square far enough for copy_square().
template <class Pixel>
bool has_whole_rows(const GreyOverBackground<Pixel>& grey, PixelIndex middle, std::int32_t radius) noexcept {
  return grey.width() >= static_cast<std::int32_t>(SpotBatch::kRow) && middle.x >= radius && middle.y >= radius &&
         middle.x + radius < grey.width() && middle.y + radius + 1 < grey.height();
}

}  // namespace rptv
