// SPDX-License-Identifier: MIT
// The scan: pixels are compared with their limits 64 at once, and only where some are lit also with their neighbours.
#include "reconstruct/detection/lit_maxima.hpp"

#include <bit>

#include "reconstruct/detection/lit_chunks.hpp"
#include "reconstruct/detection/lit_maxima_mask.hpp"

namespace rptv {

namespace {

// Takes pixel numbers in raster order and keeps those that are not in the first or last column.
class MaximaSink {
 public:
  MaximaSink(const ImageShape& shape, std::span<PixelIndex> maxima) noexcept
      : width_(shape.width_px), maxima_(maxima) {}

  void push(std::size_t pixel) noexcept {
    if (pixel >= row_begin_ + width_) {
      row_ = pixel / width_;
      row_begin_ = row_ * width_;
    }
    const std::size_t column = pixel - row_begin_;
    if (column == 0 || column + 1 == width_) return;
    if (count_ < maxima_.size()) maxima_[count_] = {static_cast<std::int32_t>(column), static_cast<std::int32_t>(row_)};
    ++count_;
  }
  std::size_t count() const noexcept { return count_; }

 private:
  const std::size_t width_;
  const std::span<PixelIndex> maxima_;
  std::size_t count_ = 0, row_ = 0, row_begin_ = 0;
};

// Compiled once per instruction set. Between rows the neighbours of a pixel are those of another row, in memory; the
// sink leaves such pixels out. Blocks without a maximum are dropped without a branch, as those without a lit pixel.
template <class Lit, class Maxima, class Pixel>
[[gnu::always_inline]] inline std::size_t scan_maxima(const Pixel* pixels, const ImageShape& shape,
                                                      const DarkLimit& limit, std::span<PixelIndex> maxima) noexcept {
  if (shape.width_px < 3 || shape.height_px < 3) return 0;
  const auto stride = static_cast<std::ptrdiff_t>(shape.width_px);
  MaximaSink sink(shape, maxima);
  each_lit_chunk<Lit>(
      pixels, limit, shape.width_px + 1, shape.pixels() - shape.width_px - 1,
      [&](LitChunk & chunk, std::size_t lit) __attribute__((always_inline)) {
        std::size_t kept = 0;
        for (std::size_t k = 0; k < lit; ++k) {
          chunk.at[kept] = chunk.at[k], chunk.mask[kept] = Maxima::among(chunk.mask[k], pixels + chunk.at[k], stride);
          kept += chunk.mask[kept] != 0;
        }
        for (std::size_t k = 0; k < kept; ++k)
          for (std::uint64_t mask = chunk.mask[k]; mask != 0; mask &= mask - 1)
            sink.push(chunk.at[k] + static_cast<std::size_t>(std::countr_zero(mask)));
      },
      [&](std::size_t i) __attribute__((always_inline)) {
        if (is_maximum(pixels + i, stride)) sink.push(i);
      });
  return sink.count();
}

#define RPTV_SCAN(SET, TARGET, LIT, MAXIMA)                                                                         \
  TARGET std::size_t scan_##SET(const ImageView& image, const DarkLimit& limit,                                     \
                                std::span<PixelIndex> maxima) noexcept {                                            \
    return image.shape.bytes_per_pixel == 1 ? scan_maxima<LIT, MAXIMA>(image.as_u8(), image.shape, limit, maxima)   \
                                            : scan_maxima<LIT, MAXIMA>(image.as_u16(), image.shape, limit, maxima); \
  }

RPTV_SCAN(portable, , LitMask, MaximaMask)
#if defined(__x86_64__)
RPTV_SCAN(avx2, RPTV_LIT_AVX2, LitMaskAvx2, MaximaMaskAvx2)
RPTV_SCAN(avx512, RPTV_LIT_AVX512, LitMaskAvx512, MaximaMaskAvx512)
#endif

}  // namespace

std::size_t find_lit_maxima(const ImageView& image, const DarkLimit& limit, std::span<PixelIndex> maxima,
                            InstructionSet set) noexcept {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return scan_avx512(image, limit, maxima);
  if (set == InstructionSet::avx2) return scan_avx2(image, limit, maxima);
#endif
  static_cast<void>(set);
  return scan_portable(image, limit, maxima);
}

}  // namespace rptv
