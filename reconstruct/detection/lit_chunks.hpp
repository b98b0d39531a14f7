// SPDX-License-Identifier: MIT
// Which of an image's blocks of 64 pixels hold lit ones: the loop under every search for particle images.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "reconstruct/lit_mask.hpp"
#include "reconstruct/lit_pixels.hpp"

namespace rptv {

/// Blocks with lit pixels: block k begins at pixel at[k], and bit i of mask[k] is its pixel i.
struct LitChunk {
  static constexpr std::size_t kBlocks = 256;  ///< so few that what the next step reads is still in the nearest cache

  std::array<std::size_t, kBlocks> at;
  std::array<std::uint64_t, kBlocks> mask;
};

/// Goes through the pixels begin … end, in raster order: take_blocks(chunk, how many blocks it has) again and again,
/// then take_pixel(i) for those lit ones that no longer fill a block. Blocks without a lit pixel are dropped without a
/// branch, which would be guessed wrong once for every row of every particle image.
template <class Lit, class Pixel, class TakeBlocks, class TakePixel>
[[gnu::always_inline]] inline void each_lit_chunk(const Pixel* pixels, const DarkLimit& limit, std::size_t begin,
                                                  std::size_t end, const TakeBlocks& take_blocks,
                                                  const TakePixel& take_pixel) noexcept {
  const std::uint16_t* limits = limit.limits().data();
  const std::size_t step = limit.uniform() ? 0 : 1;  // the same limits again: half of the memory traffic
  LitChunk chunk;
  std::size_t i = begin;
  while (i + 64 <= end) {
    std::size_t lit = 0;
    for (std::size_t block = 0; block < LitChunk::kBlocks && i + 64 <= end; ++block, i += 64) {
      chunk.at[lit] = i, chunk.mask[lit] = Lit::above(pixels + i, limits + step * i);
      lit += chunk.mask[lit] != 0;
    }
    take_blocks(chunk, lit);
  }
  for (; i < end; ++i)
    if (pixels[i] > limits[i]) take_pixel(i);
}

}  // namespace rptv
