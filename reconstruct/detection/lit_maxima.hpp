// SPDX-License-Identifier: MIT
// Where particle images are brightest: the one pass over a whole image of the multi-view front end.
#pragma once

#include <cstdint>
#include <span>

#include "core/image.hpp"
#include "core/instruction_set.hpp"
#include "reconstruct/lit_pixels.hpp"

namespace rptv {

/// Column and row of a pixel.
struct PixelIndex {
  std::int32_t x = 0, y = 0;
  bool operator==(const PixelIndex&) const = default;
};

/// Writes the pixels above their limit that are local maxima of their eight neighbours (of equal neighbours the first)
/// into `maxima`, in raster order, and returns how many there are: more than maxima.size() means that the last ones
/// were left out. The outermost rows and columns are not searched: what is brightest there has its centre elsewhere.
/// `image` has limit.size() pixels. No allocation; any thread.
std::size_t find_lit_maxima(const ImageView& image, const DarkLimit& limit, std::span<PixelIndex> maxima,
                            InstructionSet set = best_instruction_set()) noexcept;

}  // namespace rptv
